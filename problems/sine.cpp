// A sine along one axis, a steep line along the other, both rotated: with z = R_φ x,
//
//   form=code    P(x) = (sin(γ z1/ξ), γ ξ z2)       form=paper   P(x) = (sin(γ z1)/ξ, γ ξ z2)
//
// Holl, Koltun, Thuerey (2022), Fig. 5. The paper prints the second form, its scripts compute the
// first, and the figure agrees with the scripts. Both are published as learning problems over
// y* ~ U([−1, 1]²); y* = (0.3, −0.5) is that of the figure's landscape. In the paper's form y1* is
// divided by ξ, or no x would reach it.
#include <cmath>
#include <numbers>

#include "problems/dense_physics.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

struct Options {
  Real gamma = 10, xi = 10, phi = 45;
  std::string form = "code";
  Learning learning{.network = "mlp[layers=32-64-32]", .batch = 100};
};
void fields(Options& o, auto& field) {
  field("gamma", o.gamma, between(0.1, 100), "scale γ of both coordinates");
  field("xi", o.xi, between(1, 1000), "conditioning ξ");
  field("phi", o.phi, between(-180, 180), "rotation φ in degrees");
  field("form", o.form, {"code", "paper"}, "whether ξ divides inside the sine or outside");
  fields(o.learning, field);
}

class Sine final : public DensePhysics {
 public:
  explicit Sine(const Options& o) : DensePhysics(2, 2) {
    const bool inside = o.form == "code";
    amplitude_ = inside ? 1 : 1 / o.xi;
    frequency_ = inside ? o.gamma / o.xi : o.gamma;
    slope_ = o.gamma * o.xi;
    const Real phi = o.phi * std::numbers::pi / 180;
    cos_ = std::cos(phi);
    sin_ = std::sin(phi);
  }
  Real amplitude() const { return amplitude_; }
  // The x on the axis of z1 where the sine's argument is s1.
  Eigen::Vector2d at_phase(Real s1) const {
    return Eigen::Vector2d(cos_, -sin_) * (s1 / frequency_);
  }

  void value(VectorRef x, VectorOut y) const override {
    y << amplitude_ * std::sin(frequency_ * z1(x)), slope_ * z2(x);
  }
  void derivative(VectorRef x, BatchOut J) const override {
    const Real rise = amplitude_ * frequency_ * std::cos(frequency_ * z1(x));
    J << rise * cos_, -rise * sin_, slope_ * sin_, slope_ * cos_;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    const Real s1 = frequency_ * z1(x);
    const Real bend = -u[0] * amplitude_ * frequency_ * frequency_ * std::sin(s1);
    H << bend * cos_ * cos_, -bend * cos_ * sin_, -bend * cos_ * sin_, bend * sin_ * sin_;
  }

  // The solution nearest x0: of the sine's two families, the closer member of the closer one.
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef x0, VectorOut x) const override {
    const Real u = y[0] / amplitude_;
    x << x0[0], x0[1];
    if (!(std::abs(u) <= 1)) return false;
    const Real s1 = frequency_ * z1(x0), angle = std::asin(u);
    const Real rising = nearest(angle, s1);
    const Real falling = nearest(std::numbers::pi - angle, s1);
    const Real s = std::abs(rising - s1) <= std::abs(falling - s1) ? rising : falling;
    const Real solved1 = s / frequency_, solved2 = y[1] / slope_;
    x << cos_ * solved1 + sin_ * solved2, -sin_ * solved1 + cos_ * solved2;
    return true;
  }

 private:
  Real z1(VectorRef x) const { return cos_ * x[0] - sin_ * x[1]; }
  Real z2(VectorRef x) const { return sin_ * x[0] + cos_ * x[1]; }
  static Real nearest(Real s, Real s1) {  // s + 2πn closest to s1
    constexpr Real kPeriod = 2 * std::numbers::pi;
    return s + kPeriod * std::rint((s1 - s) / kPeriod);
  }

  Real amplitude_, frequency_, slope_, cos_, sin_;
};

// Mean distance to the solution nearest each x.
Real distance(const Sine& physics, BatchRef target, BatchRef x) {
  Real sum = 0;
  Eigen::Vector2d solution;
  for (Index b = 0; b < x.cols(); ++b) {
    physics.invert(target.col(b), x.col(b), solution);
    sum += (x.col(b) - solution).norm();
  }
  return sum / static_cast<Real>(x.cols());
}

// y* ~ U([−1, 1]²), the network's input; x* is the solution nearest a random phase of three periods
// of the sine, so that what it teaches is a multivalued map.
ProblemParts learn_sine(const Options& o, const Draw& draw) {
  const auto physics = std::make_shared<const Sine>(o);
  const auto sample = [physics](RandomStream& stream, Index b, Batch& batch) {
    batch.target.col(b) << physics->amplitude() * stream.uniform(-1, 1), stream.uniform(-1, 1);
    batch.input.col(b) = batch.target.col(b);
    const Eigen::Vector2d near = physics->at_phase(3 * std::numbers::pi * stream.uniform(-1, 1));
    physics->invert(batch.target.col(b), near, batch.truth.col(b));
  };
  return learn(
      o.learning, {.inputs = 2, .outputs = 2}, draw,
      {.physics = std::make_unique<Sine>(o),
       .x_error = [physics](BatchRef x,
                            const Batch& batch) { return distance(*physics, batch.target, x); },
       .samples = {.draw = sample}});
}

ProblemParts make_sine(const Options& o, const Draw& draw) {
  if (o.learning.is_on()) return learn_sine(o, draw);
  const auto physics = std::make_shared<const Sine>(o);
  Vector target = draw.is_published() ? Vector(Eigen::Vector2d(0.3, -0.5))
                                      : draw.stream("target").uniform_vector(2, -1, 1);
  target[0] *= physics->amplitude();
  Vector truth(2);
  physics->invert(target, Vector::Zero(2), truth);
  const Eigen::Vector2d corner = Eigen::Vector2d(12, 6) / o.gamma;
  return {.physics = std::make_unique<Sine>(o),
          .start = draw.start(corner / 2),  // away from every solution, at any ξ and φ
          .target = target,
          .minimum = 0,
          .truth = truth,
          .x_error = [physics, target](BatchRef x,
                                       const Batch&) { return distance(*physics, target, x); },
          .window = {{-corner[0], corner[0], -corner[1], corner[1]}},
          .contour_spacing = "fifth root"};  // as in Fig. 5a
}

}  // namespace

void register_sine(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "sine",
       .title = "Rotated sine",
       .group = Group::toy,
       .formula = "P(x) = (sin(γz₁/ξ), γξz₂),  z = R_φ x,  L = ½‖P(x) − y*‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 5",
       .note =
           "form=code is as in the published scripts; form=paper, (sin(γz₁)/ξ, γξz₂), is as in "
           "the paper, with y₁* divided by ξ. Published as a learning problem; "
           "the start (6, 3)/γ, half-way to the corner of the plotted region, is our own choice.",
       .aim = Aim::loss,  // infinitely many x give y*, and any of them will do
       .panels = {{.title = "Fig. 5b: ξ = 1, φ = 45°",
                   .kind = "curve",
                   .where = {{"xi", 1}, {"phi", 45}}},
                  {.title = "Fig. 5c: ξ = 32, φ = 45°",
                   .kind = "curve",
                   .where = {{"xi", 32}, {"phi", 45}}},
                  {.title = "Appendix: learning curves", .kind = "curve"},
                  {.title = "Appendix: loss", .kind = "series", .quantity = "loss"},
                  {.title = "Fig. 5d: relative error over ξ, φ = 0",
                   .kind = "sweep",
                   .where = {{"phi", 0}},
                   .over = "xi",
                   .divided_by = "xi"},
                  {.title = "Fig. 5e: error over φ, ξ = 32",
                   .kind = "sweep",
                   .where = {{"xi", 32}},
                   .over = "phi"}}},
      make_sine));
}

}  // namespace isoline::problems
