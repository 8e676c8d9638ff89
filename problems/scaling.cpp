// P(x) = (x1, α x2), y* = 0: a change of units. A method that is invariant under linear maps of x
// takes the same path in y for every α. Thuerey et al., Physics-based Deep Learning, chapter
// "Scale-Invariance and Inversion". The start P⁻¹(3, 3), equal for all α, is our own choice. The
// book's loss is |P|²; here, as in all problems, half of that. loss=square is the book's.
#include "problems/dense_physics.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

struct Options {
  Real alpha = 0.1;
  std::string loss;
};
void fields(Options& o, auto& field) {
  field("alpha", o.alpha, between(1e-3, 1e3), "scale α of the second coordinate");
  field("loss", o.loss, {"", "square"}, "square: ‖P(x)‖², as in the book, instead of half of it");
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
          .loss = std::make_unique<HalfSquared>(o.loss == "square" ? 2 : 1),
          .minimum = 0,
          .truth = Vector::Zero(2),
          .x_error = [](BatchRef x, const Batch&) { return x.norm(); },
          .window = {{-3.5, 3.5, -3.5 / o.alpha, 3.5 / o.alpha}}};
}

}  // namespace

void register_scaling(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "scaling",
       .title = "One scaled coordinate",
       .group = Group::toy,
       .formula = "P(x) = (x₁, αx₂),  L = ½‖P(x)‖²",
       .source = "Thuerey et al., Physics-based Deep Learning, chapter "
                 "Scale-Invariance and Inversion",
       .note =
           "The book's loss is |P|², loss=square here; by default half of that, so that 2η here "
           "equals η there.",
       .aim = Aim::x},  // P is one to one
      make_scaling));
}

}  // namespace isoline::problems
