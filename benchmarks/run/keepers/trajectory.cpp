// The path in x and y, where both are small.
#include <algorithm>

#include "benchmarks/run/keepers/keeper.h"

namespace isoline::benchmarks {
namespace {

struct Path {
  static constexpr int kInputs = 3, kOutputs = 16;
  int inputs = 0, outputs = 0;  // sizes of x and y; 0: not kept
  double x[Trace::kPoints][kInputs], y[Trace::kPoints][kOutputs];

  void begin(const Meter& f) {
    const problems::Problem& problem = f.problem();
    const problems::Model* const model = problem.model();
    const Index k = model ? std::ssize(model->names) : problem.inputs();
    if (k > kInputs || problem.residuals() > kOutputs || problem.samples() != 1) return;
    inputs = static_cast<int>(k);
    outputs = static_cast<int>(problem.residuals());
  }

  void keep(const Meter& f, int point) {
    if (inputs == 0) return;
    const problems::Problem& problem = f.problem();
    const bool is_own = problem.own_units().scales.size() > 0 ||
                        (problem.model() != nullptr && f.trace().unknowns > 0);
    const Matrix at = is_own ? Matrix(problem.in_own_units(f.judged())) : f.judged_point().x();
    std::copy_n(at.data(), inputs, x[point]);
    std::copy_n(f.judged_point().y.data(), outputs, y[point]);
  }

  std::string defect() const {
    return is_within(inputs, kInputs) && is_within(outputs, kOutputs) ? ""
                                                                      : "a path of an invalid size";
  }

  void write(const Trace& trace, Parts& parts) const {
    if (inputs == 0) return;
    Trajectory& path = parts.trajectory.emplace();
    for (int i = 0; i < trace.points; ++i) {
      path.x.emplace_back(x[i], x[i] + inputs);
      path.y.emplace_back(y[i], y[i] + outputs);
    }
  }
};

}  // namespace

Keeper trajectory_keeper() { return keeper_of<Path>(); }

}  // namespace isoline::benchmarks
