// What runs took to reach each tolerance, and each of the 51 targets.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/ladder.h"
#include "reports/read/comparison.h"

namespace isoline::reports {

inline constexpr std::size_t kTargets = kRungs;

// The least loss any run of a problem and seed has reached: f_L where none is declared.
class BestKnown {
 public:
  using Minima = std::map<std::pair<std::string, std::uint64_t>, Real>;  // by problem and seed

  explicit BestKnown(const Study& study);
  explicit BestKnown(Minima least) : least_(std::move(least)) {}
  // Declared, else the best known; not-a-number where no run of its problem and seed is.
  Real minimum(const Record& record) const;

 private:
  Minima least_;
};

// The loss that counts as reached at τ: f_L + τ s. The one place that says so.
inline Real goal(const Run& run, Real tau) { return run.minimum + tau * run.scale; }

// What is left of the way at each kept point: (f − f_L) / s, or the error in x over the solution's
// norm. Infinite where the way has no length.
std::vector<Real> losses_left(const Run& run);
std::vector<Real> left_of_aim(const Run& run);

// What a run had taken when it first met a target.
struct Reached {
  std::array<Real, kMeasures.size()> taken{};  // by measure
  bool is_bound = false;                       // kept points were skipped before: at most that

  Real by(Measure measure) const { return taken[static_cast<std::size_t>(measure)]; }
};
// The targets τ = 10^(−j/5), j = 0, 1, … until one that it never met. Of losses exact where the
// record has hits; all else is read at the kept points of its curve. Needs minimum and scale.
std::vector<Reached> ladder_of(const Run& run, const Prices& prices, Aim aim);

// Fills all that a run took, and its minimum and scale; its aim must be there.
void fill_reached(Run& run, const BestKnown& best, const Prices& prices = {},
                  const Yardstick& yardstick = {});

// What each of the targets took, over seeds: what the page's slider of tolerance reads.
struct TargetMedians {
  // By measure: of the targets of finite median, as many of each.
  std::array<std::vector<Real>, kMeasures.size()> taken;
  std::vector<std::size_t> reached;  // how many targets each run reached, by seed

  Real at(Measure by, std::size_t target) const;  // infinite where the median run is not there
  std::size_t runs_at(std::size_t target) const;  // that get there
};
TargetMedians target_medians(const Comparison& comparison, const Cell& cell);

}  // namespace isoline::reports
