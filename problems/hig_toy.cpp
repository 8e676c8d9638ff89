// The toy of half-inverse gradients, Schnell, Holl, Thuerey (2022), as in the figure of the
// Physics-based Deep Learning book: a network t ↦ x of seven tanh neurons fits ŷ(t) = (sin 6t, cos
// 9t) for t ∈ [−1, 1] by ½(x₁ − ŷ₁)² + ½(λx₂ − ŷ₂)². The plotted state is (x₁, λx₂), so λ is the
// physics, P(x) = (x₁, λx₂), and J carries it: at λ = 0.01 the network must reach 100. With x₁
// exact and x₂ = 0 the loss is ½⟨cos² 9t⟩ = 0.2395. Batch, start and number of samples are not
// published: 256 fixed samples, Glorot's start. The traced series are those of the figure: mean and
// spread of the hidden neurons over the validation, of all together and of each, and y at the t
// nearest π/9, whose target is (0.87, −1).
#include <cmath>
#include <numbers>

#include "problems/dense_physics.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

struct Options {
  Real lambda = 1;
  Learning learning{.mode = "learn",
                    .network = "mlp[layers=7,activation=tanh,precision=double,init=glorot]",
                    .batch = 256,
                    .data = 256};
};
void fields(Options& o, auto& field) {
  field("lambda", o.lambda, between(1e-6, 1e6), "scale λ of the second component");
  fields(o.learning, field);
}

class Scaled final : public DensePhysics {
 public:
  explicit Scaled(Real lambda) : DensePhysics(2, 2), lambda_(lambda) {}
  void value(VectorRef x, VectorOut y) const override { y << x[0], lambda_ * x[1]; }
  void derivative(VectorRef, BatchOut J) const override { J.diagonal() << 1, lambda_; }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef, BatchOut) const override {}

  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef, VectorOut x) const override {
    x << y[0], y[1] / lambda_;
    return true;
  }

 private:
  Real lambda_;
};

Vector curve(Real t) { return Eigen::Vector2d(std::sin(6 * t), std::cos(9 * t)); }

constexpr Index kShownNeurons = 7;  // as many as the published network has

Index nearest_to_the_shown(const Batch& batch) {
  Index nearest = 0;
  (batch.input.row(0).array() - std::numbers::pi / 9).abs().minCoeff(&nearest);
  return nearest;
}

ProblemParts make_hig_toy(const Options& o, const Draw& draw) {
  require(o.learning.is_on(),
          "hig-toy: mode=direct does not apply, since the problem can only be learned");
  const auto sample = [lambda = o.lambda](RandomStream& stream, Index b, Batch& batch) {
    batch.input(0, b) = stream.uniform(-1, 1);
    batch.target.col(b) = curve(batch.input(0, b));
    batch.truth.col(b) << batch.target(0, b), batch.target(1, b) / lambda;
  };
  const auto distance = [](BatchRef x, const Batch& batch) {
    return (x - batch.truth).colwise().norm().mean();
  };
  ProblemParts parts = learn(o.learning, {.inputs = 1, .outputs = 2}, draw,
                             {.physics = std::make_unique<Scaled>(o.lambda),
                              .x_error = distance,
                              .samples = {.draw = sample}});
  const Series shown = path({"y1 at t = π/9", "y2 at t = π/9"}, nearest_to_the_shown);
  parts.series = joined(std::move(parts.series), joined(hidden_activity(*parts.network), shown));
  parts.series = joined(std::move(parts.series), saturation(*parts.network, kShownNeurons));
  return parts;
}

}  // namespace

void register_hig_toy(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "hig-toy",
       .title = "Toy of half-inverse gradients",
       .group = Group::toy,
       .formula = "x = N(t; θ),  P(x) = (x₁, λx₂),  y*(t) = (sin 6t, cos 9t)",
       .source = "Schnell, Holl, Thuerey (2022), toy example, as in the book's figure",
       .note = "The published batch, start and rates are unknown: 256 fixed samples of t and "
               "Glorot's start are our own choices.",
       .aim = Aim::loss,  // the user fits a curve; x has no meaning
       .panels = {{.title = "Mean of the hidden neurons",
                   .kind = "series",
                   .quantity = "mean of the hidden neurons"},
                  {.title = "Spread of the hidden neurons",
                   .kind = "series",
                   .quantity = "spread of the hidden neurons"},
                  {.title = "Saturated neurons", .kind = "series", .quantity = "saturated neurons"},
                  {.title = "Path of y at t = π/9",
                   .kind = "path",
                   .quantity = "y1 at t = π/9|y2 at t = π/9"}}},
      make_hig_toy));
}

}  // namespace isoline::problems
