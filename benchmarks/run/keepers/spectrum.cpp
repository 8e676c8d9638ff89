// Singular values of J = ∂y/∂θ at iterations 0, 1, 2, 4, 8, …, or the first kept one after each,
// and the last, if they are wanted: over the batch of the step that led there.
#include <algorithm>

#include "benchmarks/run/keepers/keeper.h"
#include "core/decompose.h"

namespace isoline::benchmarks {
namespace {

struct Spectra {
  static constexpr int kPlaces = 48, kValues = 2048;
  int values = 0, taken = 0;
  std::int64_t iteration[kPlaces];
  double sigma[kPlaces][kValues];  // descending

  void keep(const Meter& f, int) { take(f, std::max<std::int64_t>(1, 2 * last())); }
  void end(const Meter& f, Status) { take(f, last() + 1); }

  std::int64_t last() const { return taken > 0 ? iteration[taken - 1] : 0; }

  // A J that is not finite has no spectrum.
  void take(const Meter& f, std::int64_t due) {
    constexpr Index kMostNumbers = Index{1} << 26;  // of J: half a gibibyte
    const problems::Problem& problem = f.problem();
    const Index rows = problem.residuals(), columns = problem.unknowns();
    if (!f.trace().wants_spectra || taken == kPlaces || (taken > 0 && f.iteration() < due) ||
        !problem.offers().contains(Oracle::jacobian) || std::min(rows, columns) > kValues ||
        rows * columns > kMostNumbers)
      return;
    problems::Point point;
    Matrix J;  // (m·B, n)
    Vector found;
    problem.forward(f.judged(), f.samples_of_step(), point);
    problem.jacobian(J, point);
    if (!singular_values(J, found)) return;
    values = static_cast<int>(found.size());
    std::copy_n(found.data(), found.size(), sigma[taken]);
    iteration[taken] = f.iteration();
    ++taken;
  }

  std::string defect() const {
    constexpr const char* kDefect = "spectra of an invalid size or at invalid iterations";
    if (!is_within(values, kValues) || !is_within(taken, kPlaces)) return kDefect;
    return std::ranges::adjacent_find(iteration, iteration + taken, std::greater_equal()) ==
                       iteration + taken &&
                   (taken == 0 || iteration[0] >= 0)
               ? ""
               : kDefect;
  }

  void write(const Trace& trace, Parts& parts) const {
    if (!trace.wants_spectra) return;
    Spectrum& spectrum = parts.spectrum.emplace();
    for (int i = 0; i < taken; ++i) {
      spectrum.iterations.push_back(iteration[i]);
      spectrum.sigma.emplace_back(sigma[i], sigma[i] + values);
    }
  }
};

}  // namespace

Keeper spectrum_keeper() { return keeper_of<Spectra>(); }

}  // namespace isoline::benchmarks
