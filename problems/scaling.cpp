// P(x) = (x1, α x2), y* = 0: nothing but a change of units. A method invariant under linear maps of
// x takes the same path in y for every α; the start is P⁻¹(3, 3), as in Holl, Koltun, Thuerey
// (2022), Fig. 1, so that all α share it.
#include "problems/dense_physics.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

struct Options {
  Real alpha = 0.1;
};
void fields(Options& o, auto& field) {
  field("alpha", o.alpha, between(1e-3, 1e3), "scale α of the second coordinate");
}

class Scaling final : public DensePhysics {
 public:
  explicit Scaling(Real alpha) : DensePhysics(2, 2), alpha_(alpha) {}
  void value(VectorRef x, VectorOut y) const override { y << x[0], alpha_ * x[1]; }
  void derivative(VectorRef, BatchOut J) const override {
    J(0, 0) = 1;
    J(1, 1) = alpha_;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef, BatchOut) const override {}
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef, VectorOut x) const override {
    x << y[0], y[1] / alpha_;
    return true;
  }

 private:
  Real alpha_;
};

ProblemParts make_scaling(const Options& o, const Draw& draw) {
  auto physics = std::make_unique<Scaling>(o.alpha);
  const Eigen::Vector2d y0(3, 3);
  Vector x0(2);  // P⁻¹(3, 3)
  physics->invert(y0, y0, x0);
  return {.physics = std::move(physics),
          .start = draw.start(x0),
          .target = Vector::Zero(2),
          .minimum = 0,
          .truth = Vector::Zero(2),
          .x_error = [](BatchRef x, const Batch&) { return x.norm(); },
          .window = {{-3.5, 3.5, -3.5 / o.alpha, 3.5 / o.alpha}}};
}

}  // namespace

void register_scaling(ProblemRegistry& registry) {
  registry.add(problem_entry({.name = "scaling",
                              .title = "One scaled coordinate",
                              .formula = "P(x) = (x₁, αx₂),  L = ½‖P(x)‖²",
                              .source = "After Holl, Koltun, Thuerey (2022), Fig. 1",
                              .aim = Aim::x},  // P is one to one
                             make_scaling));
}

}  // namespace isoline::problems
