// Brown's badly scaled function: f1 = x1 − 10⁶, f2 = x2 − 2·10⁻⁶, f3 = x1 x2 − 2. Moré, Garbow,
// Hillstrom (1981), problem 4.
#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

class BrownBadlyScaled final : public DensePhysics {
 public:
  BrownBadlyScaled() : DensePhysics(2, 3) {}
  void value(VectorRef x, VectorOut y) const override {
    y << x[0] - 1e6, x[1] - 2e-6, x[0] * x[1] - 2;
  }
  void derivative(VectorRef x, BatchOut J) const override { J << 1, 0, 0, 1, x[1], x[0]; }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef u, BatchOut H) const override { H(0, 1) = H(1, 0) = u[2]; }
};

ProblemParts make_brown_badly_scaled(const NoOptions&, const Draw& draw) {
  return classical(std::make_unique<BrownBadlyScaled>(), Eigen::Vector2d(1, 1), draw, 0,
                   Eigen::Vector2d(1e6, 2e-6));
}

}  // namespace

void register_brown_badly_scaled(ProblemRegistry& registry) {
  registry.add(problem_entry({.name = "brown-badly-scaled",
                              .title = "Brown's badly scaled function",
                              .group = Group::classical,
                              .formula = "f = (x₁ − 10⁶, x₂ − 2·10⁻⁶, x₁x₂ − 2),  L = ½Σfᵢ²",
                              .source = "Moré, Garbow, Hillstrom (1981), problem 4"},
                             make_brown_badly_scaled));
}

}  // namespace isoline::problems
