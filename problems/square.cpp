// P(x) = (x1, x2²), y* = 0, L = ‖y − y*‖² without ½: Holl et al. (2022), Fig. 1 and the comparison
// notebook of the Physics-based Deep Learning book, which tests its inverse at y* = (2, 2).
#include <cmath>

#include "problems/dense_physics.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

struct Options {
  std::string target;
};
void fields(Options& o, auto& field) {
  field("target", o.target, {"", "test"}, "test: y* = (2, 2), as the notebook tests its inverse");
}

class Square final : public DensePhysics {
 public:
  Square() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override { y << x[0], x[1] * x[1]; }
  void derivative(VectorRef x, BatchOut J) const override {
    J(0, 0) = 1;
    J(1, 1) = 2 * x[1];
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef u, BatchOut H) const override { H(1, 1) = 2 * u[1]; }
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef x0, VectorOut x) const override {  // the root on x0's side
    if (y[1] < 0) return false;
    x << y[0], std::copysign(std::sqrt(y[1]), x0[1]);
    return true;
  }
};

ProblemParts make_square(const Options& o, const Draw& draw) {
  const Real y = o.target == "test" ? 2 : 0;
  const Eigen::Vector2d truth(y, std::sqrt(y));
  return {.physics = std::make_unique<Square>(),
          .start = draw.start(Eigen::Vector2d(3, 3)),
          .target = Vector::Constant(2, y),
          .loss = std::make_unique<HalfSquared>(2),
          .minimum = 0,
          .truth = Vector(truth),
          .x_error = [truth](BatchRef x, const Batch&) { return (x - truth).norm(); },
          .window = {{-0.3, 3.2, -0.1, 3.5}},  // the axes and levels of Fig. 1
          .y_window = {{-0.3, 3.2, -0.1, 9.5}},
          .contour_spacing = "powers of two"};
}

}  // namespace

void register_square(ProblemRegistry& registry) {
  registry.add(problem_entry({.name = "square",
                              .title = "One squared coordinate",
                              .group = Group::toy,
                              .formula = "P(x) = (x₁, x₂²),  L = ‖P(x)‖²",
                              .source = "Holl, Koltun, Thuerey (2022), Fig. 1",
                              .note = "The loss has no factor ½, as in the published notebook.",
                              .aim = Aim::x},  // y* = 0 comes of x = 0 alone
                             make_square));
}

}  // namespace isoline::problems
