// Toy problems with two uncoupled coordinates.
#include <cmath>
#include <numbers>

#include "problems/dense_physics.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

// P(x) = (x1, α x2), y* = 0: a change of units. A method that is invariant under linear maps of x
// takes the same path in y for every α. Thuerey et al., Physics-based Deep Learning, chapter
// "Scale-Invariance and Inversion". The start P⁻¹(3, 3), equal for all α, is our own choice. The
// book's loss is |P|²; here, as in all problems, half of that. loss=square is the book's.
struct ScalingOptions {
  Real alpha = 0.1;
  std::string loss;
};
void fields(ScalingOptions& o, auto& field) {
  field("alpha", o.alpha, between(1e-3, 1e3), "scale α of the second coordinate");
  field("loss", o.loss, {"", "square"}, "square: ‖P(x)‖², as in the book, instead of half of it");
}

class Scaling final : public DensePhysics {
 public:
  explicit Scaling(Real alpha) : DensePhysics(2, 2), alpha_(alpha) {}
  void value(VectorRef x, VectorOut y) const override { y << x[0], alpha_ * x[1]; }
  void derivative(VectorRef, BatchOut J) const override { J.diagonal() << 1, alpha_; }
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

ProblemParts make_scaling(const ScalingOptions& o, const Draw& draw) {
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

// P(x) = (x1, x2²), y* = 0, L = ‖y − y*‖² without ½: Holl et al. (2022), Fig. 1 and the comparison
// notebook of the Physics-based Deep Learning book, which tests its inverse at y* = (2, 2).
struct SquareOptions {
  std::string target;
};
void fields(SquareOptions& o, auto& field) {
  field("target", o.target, {"", "test"}, "test: y* = (2, 2), as the notebook tests its inverse");
}

class Square final : public DensePhysics {
 public:
  explicit Square(Real ripple = 0) : DensePhysics(2, 2), ripple_(ripple) {}
  void value(VectorRef x, VectorOut y) const override {
    y << x[0], x[1] * x[1];
    if (ripple_ > 0) y += ripple_ * (kFrequency * x.array()).sin().matrix();
  }
  void derivative(VectorRef x, BatchOut J) const override {
    J(0, 0) = 1;
    J(1, 1) = 2 * x[1];
    if (ripple_ > 0) J.diagonal() += ripple_ * kFrequency * (kFrequency * x.array()).cos().matrix();
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    H(1, 1) = 2 * u[1];
    const Real bend = ripple_ * kFrequency * kFrequency;
    if (bend > 0) H.diagonal().array() -= bend * u.array() * (kFrequency * x.array()).sin();
  }
  Inverse inverse_kind() const override { return ripple_ > 0 ? Inverse::none : Inverse::exact; }
  bool invert(VectorRef y, VectorRef x0, VectorOut x) const override {  // the root on x0's side
    if (y[1] < 0) return false;
    x << y[0], std::copysign(std::sqrt(y[1]), x0[1]);
    return true;
  }

 private:
  static constexpr Real kFrequency = 100;
  Real ripple_;
};

ProblemParts make_square(const SquareOptions& o, const Draw& draw) {
  const Real y = o.target == "test" ? 2 : 0;
  const Eigen::Vector2d truth(y, std::sqrt(y));
  return {.physics = std::make_unique<Square>(),
          .start = draw.start(Eigen::Vector2d(3, 3)),
          .target = Vector::Constant(2, y),
          .loss = std::make_unique<HalfSquared>(2),
          .minimum = 0,
          .truth = Vector(truth),
          .window = {{-0.3, 3.2, -0.1, 3.5}},  // the axes and levels of Fig. 1
          .y_window = {{-0.3, 3.2, -0.1, 9.5}},
          .contour_spacing = "powers of two"};
}

// P(x) = (x1, x2²) + ε sin 100x: the second derivatives of an error of high frequency exceed those
// of P. Thuerey et al., chapter "Scale-Invariance and Inversion", on Newton's method and noise.
struct RippleOptions {
  Real ripple = 1e-3;
};
void fields(RippleOptions& o, auto& field) {
  field("ripple", o.ripple, between(0, 1), "size ε of the error");
}

ProblemParts make_rippled_square(const RippleOptions& o, const Draw& draw) {
  ProblemParts parts = make_square({}, draw);
  parts.physics = std::make_unique<Square>(o.ripple);
  return parts;
}

// The toy of half-inverse gradients, Schnell, Holl, Thuerey (2022), as in the figure of the
// Physics-based Deep Learning book: a network t ↦ x of seven tanh neurons fits ŷ(t) = (sin 6t, cos
// 9t) for t ∈ [−1, 1] by ½(x₁ − ŷ₁)² + ½(λx₂ − ŷ₂)². The plotted state is (x₁, λx₂), so λ is the
// physics, P(x) = (x₁, λx₂), and J carries it: at λ = 0.01 the network must reach 100. With x₁
// exact and x₂ = 0 the loss is ½⟨cos² 9t⟩ = 0.2395. Batch, start and number of samples are not
// published: 256 fixed samples, Glorot's start. The traced series are those of the figure: mean and
// spread of the hidden neurons over the validation, of all together and of each, and y at the t
// nearest π/9, whose target is (0.87, −1).
struct HigOptions {
  Real lambda = 1;
  std::string samples;
  Learning learning{.mode = "learn",
                    .network = "mlp[layers=7,activation=tanh,precision=double,init=glorot]",
                    .batch = 256,
                    .data = 256};
};
void fields(HigOptions& o, auto& field) {
  field("lambda", o.lambda, between(1e-6, 1e6), "scale λ of the second component");
  field("samples", o.samples, {"", "pairs"},
        "pairs: every second t lies 0.001 beside the one before, so that rows of J nearly agree");
  fields(o.learning, field);
}

constexpr Index kShownNeurons = 7;  // as many as the published network has

Index nearest_to_the_shown(const Batch& batch) {
  Index nearest = 0;
  (batch.input.row(0).array() - std::numbers::pi / 9).abs().minCoeff(&nearest);
  return nearest;
}

ProblemParts make_hig_toy(const HigOptions& o, const Draw& draw) {
  require(o.learning.is_on(), "hig-toy has only mode=learn; remove mode=direct");
  const auto sample = [o](RandomStream& stream, Index b, Batch& batch) {
    constexpr Real kApart = 1e-3;
    const bool is_second = o.samples == "pairs" && b % 2 == 1;
    const Real t = batch.input(0, b) =
        is_second ? batch.input(0, b - 1) + kApart : stream.uniform(-1, 1);
    batch.target.col(b) << std::sin(6 * t), std::cos(9 * t);
    batch.truth.col(b) << batch.target(0, b), batch.target(1, b) / o.lambda;
  };
  const auto distance = [](BatchRef x, const Batch& batch) {
    return (x - batch.truth).colwise().norm().mean();
  };
  ProblemParts parts = learn(o.learning, {.inputs = 1, .outputs = 2}, draw,
                             {.physics = std::make_unique<Scaling>(o.lambda),
                              .x_error = distance,
                              .samples = {.draw = sample}});
  const Series shown = path({"y1 at t = π/9", "y2 at t = π/9"}, nearest_to_the_shown);
  parts.series = joined(std::move(parts.series), joined(hidden_activity(*parts.network), shown));
  parts.series = joined(std::move(parts.series), saturation(*parts.network, kShownNeurons));
  return parts;
}

// P(x) = x², x* = ±√y*, y* ~ U[0, 1), both signs alike: the inverse has two modes, whose mean is 0
// and makes no y*. The opening example of the Physics-based Deep Learning book; the network is our
// own choice. An error in x is the distance to the nearer root.
struct ParabolaOptions {
  Learning learning{.mode = "learn", .network = "mlp[layers=10-10]"};
};
void fields(ParabolaOptions& o, auto& field) { fields(o.learning, field); }

class Parabola final : public DensePhysics {
 public:
  Parabola() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y[0] = x[0] * x[0]; }
  void derivative(VectorRef x, BatchOut J) const override { J(0, 0) = 2 * x[0]; }
};

ProblemParts make_parabola(const ParabolaOptions& o, const Draw& draw) {
  require(o.learning.is_on(), "parabola has only mode=learn; remove mode=direct");
  const auto sample = [](RandomStream& stream, Index b, Batch& batch) {
    const Real u = stream.uniform(-1, 1);
    batch.truth(0, b) = std::copysign(std::sqrt(std::abs(u)), u);
    batch.input(0, b) = batch.target(0, b) = std::abs(u);
  };
  const auto distance = [](BatchRef x, const Batch& batch) {
    return (x.cwiseAbs() - batch.truth.cwiseAbs()).cwiseAbs().mean();
  };
  return learn(
      o.learning, {.inputs = 1, .outputs = 1}, draw,
      {.physics = std::make_unique<Parabola>(), .x_error = distance, .samples = {.draw = sample}});
}

}  // namespace

void register_toys(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "scaling",
       .title = "One scaled coordinate",
       .group = Group::toy,
       .formula = "P(x) = (x₁, αx₂),  L = ½‖P(x)‖²",
       .source = "Thuerey et al., Physics-based Deep Learning, chapter "
                 "Scale-Invariance and Inversion",
       .note =
           "The loss of the book is |P|² (loss=square). The default loss is half of it, so a step "
           "length of 2η here equals η there.",
       .aim = Aim::x,  // P is one to one
       .is_linear = true},
      make_scaling));
  registry.add(problem_entry({.name = "square",
                              .title = "One squared coordinate",
                              .group = Group::toy,
                              .formula = "P(x) = (x₁, x₂²),  L = ‖P(x)‖²",
                              .source = "Holl, Koltun, Thuerey (2022), Fig. 1",
                              .note = "The loss has no factor ½, as in the published notebook.",
                              .aim = Aim::x},  // y* = 0 comes of x = 0 alone
                             make_square));
  registry.add(problem_entry({.name = "rippled-square",
                              .title = "One squared coordinate with an error of high frequency",
                              .group = Group::toy,
                              .formula = "P(x) = (x₁, x₂²) + ε sin 100x,  L = ‖P(x)‖²",
                              .source = "Thuerey et al., Physics-based Deep Learning, chapter "
                                        "Scale-Invariance and Inversion",
                              .aim = Aim::x,
                              .family = "square",
                              .in_all = false},
                             make_rippled_square));
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
  registry.add(problem_entry({.name = "parabola",
                              .title = "The roots of a number, learned",
                              .group = Group::toy,
                              .formula = "x = N(y*; θ),  P(x) = x²,  L = ½(P(x) − y*)²",
                              .source = "Thuerey et al., Physics-based Deep Learning, overview",
                              .aim = Aim::loss,  // either root solves it
                              .in_all = false},
                             make_parabola));
}

}  // namespace isoline::problems
