// Freudenstein and Roth's function: P(x) = (x1 − 13 + ((5 − x2) x2 − 2) x2, x1 − 29 + ((x2 + 1) x2
// − 14) x2), y* = 0. Moré, Garbow, Hillstrom (1981), problem 2: its second minimum traps most
// searches from the standard start.
#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

class FreudensteinRoth final : public DensePhysics {
 public:
  FreudensteinRoth() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override {
    y << x[0] - 13 + ((5 - x[1]) * x[1] - 2) * x[1], x[0] - 29 + ((x[1] + 1) * x[1] - 14) * x[1];
  }
  void derivative(VectorRef x, BatchOut J) const override {
    J << 1, (10 - 3 * x[1]) * x[1] - 2, 1, (3 * x[1] + 2) * x[1] - 14;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    H(1, 1) = u[0] * (10 - 6 * x[1]) + u[1] * (6 * x[1] + 2);
  }
};

ProblemParts make_freudenstein_roth(const NoOptions&, const Draw& draw) {
  return classical(std::make_unique<FreudensteinRoth>(), Eigen::Vector2d(0.5, -2), draw, 0,
                   Eigen::Vector2d(5, 4));
}

}  // namespace

void register_freudenstein_roth(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "freudenstein-roth",
       .title = "Freudenstein and Roth's function",
       .group = Group::classical,
       .formula = "f = (x₁ − 13 + ((5 − x₂) x₂ − 2) x₂, x₁ − 29 + ((x₂ + 1) x₂ − 14) x₂)",
       .source = "Moré, Garbow, Hillstrom (1981), problem 2; Freudenstein and Roth (1963)"},
      make_freudenstein_roth));
}

}  // namespace isoline::problems
