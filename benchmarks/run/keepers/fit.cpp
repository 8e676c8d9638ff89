// The data of a user's own program, or of a problem with the words of a model, and y at the
// returned point, in the units of the data.
#include "benchmarks/run/keepers/keeper.h"

namespace isoline::benchmarks {
namespace {

struct Fit {
  static constexpr int kData = 4096;
  int data = 0;  // 0: nothing is kept
  bool has_sigma = false;
  double target[kData], y[kData], sigma[kData];

  void end(const Meter& f, Status) {
    const problems::Problem& problem = f.problem();
    const problems::Model* const model = problem.model();
    const Index m = problem.residuals() - problem.penalties();
    if (f.trace().unknowns == 0 || (!problem.is_elsewhere() && !model) ||
        !problem.is_least_squares() || problem.samples() != 1 || m > kData)
      return;
    const bool has_factors = model && model->factors.size() == m;
    has_sigma = has_factors && problem.noise_level().has_value();
    for (Index i = 0; i < m; ++i) {
      const Real unit = has_factors ? 1 / model->factors[i] : 1;
      sigma[i] = unit;
      target[i] = unit * problem.target()(i, 0);
      y[i] = unit * f.judged_point().y(i, 0);
    }
    data = static_cast<int>(m);
  }

  std::string defect() const {
    return is_within(data, kData) && is_flag(has_sigma) ? "" : "data of an invalid size";
  }

  void write(const Trace&, Parts& parts) const {
    if (data == 0) return;
    parts.fit = FitData{.target = {target, target + data}, .y = {y, y + data}};
    if (has_sigma) parts.fit->sigma.assign(sigma, sigma + data);
  }
};

}  // namespace

Keeper fit_keeper() { return keeper_of<Fit>(); }

}  // namespace isoline::benchmarks
