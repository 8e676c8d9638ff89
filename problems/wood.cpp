// Wood's function: f1 = 10 (x2 − x1²), f2 = 1 − x1, f3 = √90 (x4 − x3²), f4 = 1 − x3,
// f5 = √10 (x2 + x4 − 2), f6 = (x2 − x4)/√10. Moré, Garbow, Hillstrom (1981), problem 14.
#include <cmath>

#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

const Real kRoot10 = std::sqrt(10.0), kRoot90 = std::sqrt(90.0);

class Wood final : public DensePhysics {
 public:
  Wood() : DensePhysics(4, 6) {}
  void value(VectorRef x, VectorOut y) const override {
    y << 10 * (x[1] - x[0] * x[0]), 1 - x[0], kRoot90 * (x[3] - x[2] * x[2]), 1 - x[2],
        kRoot10 * (x[1] + x[3] - 2), (x[1] - x[3]) / kRoot10;
  }
  void derivative(VectorRef x, BatchOut J) const override {
    J << -20 * x[0], 10, 0, 0,               //
        -1, 0, 0, 0,                         //
        0, 0, -2 * kRoot90 * x[2], kRoot90,  //
        0, 0, -1, 0,                         //
        0, kRoot10, 0, kRoot10,              //
        0, 1 / kRoot10, 0, -1 / kRoot10;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef u, BatchOut H) const override {
    H(0, 0) = -20 * u[0];
    H(2, 2) = -2 * kRoot90 * u[2];
  }
};

ProblemParts make_wood(const NoOptions&, const Draw& draw) {
  return classical(std::make_unique<Wood>(), Eigen::Vector4d(-3, -1, -3, -1), draw, 0,
                   Vector::Ones(4));
}

}  // namespace

void register_wood(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "wood",
       .title = "Wood's function",
       .group = Group::classical,
       .formula = "f = (10(x₂ − x₁²), 1 − x₁, √90(x₄ − x₃²), 1 − x₃, √10(x₂ + x₄ − 2), "
                  "(x₂ − x₄)/√10),  L = ½Σfᵢ²",
       .source = "Moré, Garbow, Hillstrom (1981), problem 14; Colville (1968)"},
      make_wood));
}

}  // namespace isoline::problems
