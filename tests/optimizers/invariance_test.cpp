// Invariance under rescaled inputs, as declared: a linear physics from the same y₀ in units of x
// that differ by α, so that a method whose path in y depends on them shows it.
#include <gtest/gtest.h>

#include <cmath>

#include "run.h"
#include "trial_problems.h"

namespace isoline {
namespace {

constexpr int kSteps = 10;

// P(x) = (x1, α x2), y* = 0, started at P⁻¹(3, 3).
Problem scaling(Real alpha) {
  return linear(Eigen::Vector2d(1, alpha).asDiagonal(), Eigen::Vector2d(3, 3 / alpha),
                Vector::Zero(2));
}

// The largest difference, relative to ‖y₀‖, between the paths in y for α and for 1.
Real path_difference(const std::string& spec, Real alpha) {
  const Outcome a = run(scaling(1), spec, iterations(kSteps));
  const Outcome b = run(scaling(alpha), spec, iterations(kSteps));
  const int points = std::max<int>(a.trace->points, b.trace->points);
  Real largest = 0;
  for (int i = 0; i < points; ++i) {  // a path that has ended stays where it is
    const int ia = std::min<int>(i, a.trace->points - 1);
    const int ib = std::min<int>(i, b.trace->points - 1);
    for (int row = 0; row < 2; ++row) {
      const Real gap = std::abs(a.trace->path_y[ia][row] - b.trace->path_y[ib][row]);
      largest = std::isfinite(gap) ? std::max(largest, gap) : 1;
    }
  }
  return largest / std::hypot(3, 3);
}

// Steps shorter than the whole way, where the method has such an option.
std::string cautious(const OptimizerEntry& entry) {
  if (entry.name == "sip") return "sip[step=0.3]";
  for (const char* name :
       {"newton", "gauss-newton", "inverse-gradient", "hig", "saddle-free-newton"})
    if (entry.name == name) return entry.name + "[rate=0.3]";
  return entry.name;
}

Real worst_difference(const std::string& spec) {
  Real worst = 0;
  for (const Real alpha : {1e-3, 1e-2, 0.1, 7.0, 1e2, 1e3})
    worst = std::max(worst, path_difference(spec, alpha));
  return worst;
}

TEST(Invariance, DeclaredMethodsAgreeAndOthersDoNot) {
  for (const auto& [name, entry] : optimizers()) {
    const Real worst = worst_difference(cautious(entry));
    EXPECT_EQ(worst <= 1e-9, entry.is_input_scale_invariant) << name << ": " << worst;
  }
}

TEST(Invariance, FirstOrderMethodsDifferVisibly) {
  for (const char* spec : {"gd[rate=0.1]", "adam[rate=0.1]", "hig"})
    EXPECT_GT(worst_difference(spec), 1e-2) << spec;
}

}  // namespace
}  // namespace isoline
