// Invariance under rescaled inputs, as declared: `scaling` from the same y₀ = (3, 3) in units of x
// that differ by α, so that a method whose path in y depends on them shows it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "run.h"

namespace isoline::optimizers {

using problems::Problem;
namespace {

constexpr int kSteps = 10;

Problem scaling(Real alpha) { return published("scaling[alpha=" + std::to_string(alpha) + "]"); }

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

// Steps of 0.3 of the whole way, where the method has such an option.
std::string cautious(const OptimizerEntry& entry) {
  for (const char* option : {"step", "rate"})
    for (const OptionField& field : entry.options)
      if (field.name == option) return entry.name + "[" + option + "=0.3]";
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
    if (!why_inapplicable(entry, options_of_spec(entry, name), scaling(1)).empty()) continue;
    const Real worst = worst_difference(cautious(entry));
    EXPECT_EQ(worst <= 1e-9, entry.is_input_scale_invariant) << name << ": " << worst;
  }
}

TEST(Invariance, IsDeclaredByTheMethodsOfWhichItIsClaimed) {
  for (const char* name : {"newton", "gauss-newton", "inverse-gradient", "sip"})
    EXPECT_TRUE(optimizers().at(name).is_input_scale_invariant) << name;
}

TEST(Invariance, GradientStepsDifferVisibly) {
  for (const char* spec : {"gd[rate=0.3]", "adam[rate=0.3]", "hig[rate=0.3,kappa=0.5]"})
    EXPECT_GT(worst_difference(spec), 1e-2) << spec;
}

}  // namespace
}  // namespace isoline::optimizers
