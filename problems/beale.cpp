// Beale's function: fᵢ = yᵢ − x1 (1 − x2ⁱ), y = (1.5, 2.25, 2.625). Moré, Garbow, Hillstrom (1981),
// problem 5.
#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

class Beale final : public DensePhysics {
 public:
  Beale() : DensePhysics(2, 3) {}
  void value(VectorRef x, VectorOut y) const override {
    const Real x2 = x[1];
    y << 1.5 - x[0] * (1 - x2), 2.25 - x[0] * (1 - x2 * x2), 2.625 - x[0] * (1 - x2 * x2 * x2);
  }
  void derivative(VectorRef x, BatchOut J) const override {
    const Real x2 = x[1];
    J << x2 - 1, x[0],               //
        x2 * x2 - 1, 2 * x[0] * x2,  //
        x2 * x2 * x2 - 1, 3 * x[0] * x2 * x2;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    const Real x2 = x[1];
    H(0, 1) = H(1, 0) = u[0] + 2 * u[1] * x2 + 3 * u[2] * x2 * x2;
    H(1, 1) = 2 * u[1] * x[0] + 6 * u[2] * x[0] * x2;
  }
};

ProblemParts make_beale(const NoOptions&, const Draw& draw) {
  ProblemParts parts =
      classical(std::make_unique<Beale>(), Eigen::Vector2d(1, 1), draw, 0, Eigen::Vector2d(3, 0.5));
  parts.window = {-0.5, 4.5, -1.5, 1.5};
  return parts;
}

}  // namespace

void register_beale(ProblemRegistry& registry) {
  registry.add(problem_entry({.name = "beale",
                              .title = "Beale's function",
                              .group = Group::classical,
                              .formula = "fᵢ = yᵢ − x₁(1 − x₂ⁱ),  y = (1.5, 2.25, 2.625),  "
                                         "L = ½Σfᵢ²",
                              .source = "Moré, Garbow, Hillstrom (1981), problem 5; Beale (1958)"},
                             make_beale));
}

}  // namespace isoline::problems
