// Rosenbrock's valley: f1 = 10 (x2 − x1²), f2 = 1 − x1. Moré, Garbow, Hillstrom (1981), problem 1.
#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

class Rosenbrock final : public DensePhysics {
 public:
  Rosenbrock() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override { y << 10 * (x[1] - x[0] * x[0]), 1 - x[0]; }
  void derivative(VectorRef x, BatchOut J) const override { J << -20 * x[0], 10, -1, 0; }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef u, BatchOut H) const override { H(0, 0) = -20 * u[0]; }
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef, VectorOut x) const override {
    x[0] = 1 - y[1];
    x[1] = y[0] / 10 + x[0] * x[0];
    return true;
  }
};

ProblemParts make_rosenbrock(const NoOptions&, const Draw& draw) {
  ProblemParts parts = classical(std::make_unique<Rosenbrock>(), Eigen::Vector2d(-1.2, 1), draw, 0,
                                 Eigen::Vector2d(1, 1));
  parts.window = {-2, 2, -1, 3};
  return parts;
}

}  // namespace

void register_rosenbrock(ProblemRegistry& registry) {
  registry.add(problem_entry({.name = "rosenbrock",
                              .title = "Rosenbrock's valley",
                              .group = Group::classical,
                              .formula = "f = (10(x₂ − x₁²), 1 − x₁),  L = ½Σfᵢ²",
                              .source = "Moré, Garbow, Hillstrom (1981), problem 1; "
                                        "Rosenbrock (1960)"},
                             make_rosenbrock));
}

}  // namespace isoline::problems
