// Invariance under rescaled inputs, as declared: y = A diag(α) x from the same y₀, so that a method
// whose path in y depends on α shows it.
#include <gtest/gtest.h>

#include "run.h"
#include "trial_problems.h"

namespace isoline {
namespace {

constexpr int kSteps = 10;

// The largest difference, relative to ‖y₀ − y*‖, between the paths in y for α and for 1.
Real path_difference(const std::string& spec, const Vector& alpha) {
  const Matrix A = easy_matrix();
  const Eigen::Vector2d start(1, 2), target(0.5, -0.3);
  const Problem plain = linear(A, start, target);
  const Problem scaled = linear(A * alpha.asDiagonal(), start.cwiseQuotient(alpha), target);
  const Outcome a = run(plain, spec, iterations(kSteps)), b = run(scaled, spec, iterations(kSteps));
  const int points = std::max<int>(a.trace->points, b.trace->points);
  Real largest = 0;
  for (int i = 0; i < points; ++i) {  // a path that has ended stays where it is
    const int ia = std::min<int>(i, a.trace->points - 1),
              ib = std::min<int>(i, b.trace->points - 1);
    for (int row = 0; row < 2; ++row) {
      const Real gap = std::abs(a.trace->path_y[ia][row] - b.trace->path_y[ib][row]);
      largest = std::isfinite(gap) ? std::max(largest, gap) : 1;
    }
  }
  return largest / (A * start - target).norm();
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
  for (const Eigen::Vector2d& alpha : {Eigen::Vector2d(1e-3, 1e3), Eigen::Vector2d(1e3, 1),
                                       Eigen::Vector2d(1, 1e-3), Eigen::Vector2d(1e-3, 1e-3)})
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
