// A network that solves an equation for u(x, t) with known coefficients, by least squares in θ:
//
//   L = ½ (1/N_Ω Σ r² + 1/N_∂ Σ (u − u*)²),  u = N(x, t; θ),
//   burgers     r = u_t + u u_x − ν u_xx,  |x| < 1,  u* = −sin πx at t = 0, 0 at x = ±1;
//               solution of Cole and Hopf; ν = 0.01/π; three layers of 20. SSBroyden on it: Urbán,
//               Stefanou, Pons (2025), arXiv 2405.04230; Kiyani et al. (2025), arXiv 2501.16371
//   convection  r = u_t + β u_x,  0 < x < 2π,  u* = sin(x − βt) at t = 0 and at both ends; β = 40;
//               four layers of 50. Rathore, Lei, Frangella, Lu, Udell (2024), arXiv 2402.01868
//
// and 0 < t < 1. N is a perceptron of hyperbolic tangents in double precision that sees x and t
// scaled to about 1. A sample is a point; half of the N_∂ points are at t = 0. Deviations: random
// points, fewer than published, fixed for a seed, and in place of periodic values at the ends of
// convection those of the solution. The error in x is ‖u − u*‖/‖u*‖ over the validation in Ω.
#include <cmath>
#include <memory>
#include <numbers>

#include "networks/laplacian_perceptron.h"
#include "problems/cole_hopf.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

constexpr Real kPi = std::numbers::pi;

// r = u_t + (β + s u) u_x − ν u_xx over x from `left` to `right`, in units of `length`.
struct Equation {
  std::string_view name;
  const char* layers;
  Real speed, steepening, viscosity;  // β, s, ν
  Real left, right, length;
  Real (*solution)(Real x, Real t);
};
constexpr Real kViscosity = 0.01 / kPi, kSpeed = 40;
const Equation kEquations[] = {
    {"burgers", "20-20-20", 0, 1, kViscosity, -1, 1, 1,
     [](Real x, Real t) { return t > 0 ? cole_hopf(x, t, kViscosity) : -std::sin(kPi * x); }},
    {"convection", "50-50-50-50", kSpeed, 0, 0, 0, 2 * kPi, 2 * kPi,
     [](Real x, Real t) { return std::sin(x - kSpeed * t); }}};

// (u, u_p, u_t, u_pp) at p = x/length, with the weights (of r, of u) ↦ either of both, weighted.
class ForwardResidual final : public Physics {
 public:
  explicit ForwardResidual(const Equation& of) : of_(of) {}
  Index inputs() const override { return 4; }
  Index outputs() const override { return 1; }
  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace&) const override {
    for (Index b = 0; b < x.cols(); ++b) {
      const Real u = x(0, b);
      const Real r = x(2, b) + advection(u) * x(1, b) - diffusion() * x(3, b);
      y(0, b) = c(0, b) * r + c(1, b) * u;
    }
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    for (Index b = 0; b < v.cols(); ++b) Jv(0, b) = slopes(w, b).dot(v.col(b));
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    for (Index b = 0; b < u.cols(); ++b) JTu.col(b) = slopes(w, b) * u(0, b);
  }

 private:
  Real advection(Real u) const { return (of_.speed + of_.steepening * u) / of_.length; }
  Real diffusion() const { return of_.viscosity / (of_.length * of_.length); }
  Eigen::Vector4d slopes(const Workspace& w, Index b) const {
    const Real of_r = w.context(0, b);
    return {of_r * of_.steepening / of_.length * w.x(1, b) + w.context(1, b),
            of_r * advection(w.x(0, b)), of_r, -of_r * diffusion()};
  }
  const Equation& of_;
};

struct PinnForward {
  std::string mode = kLearnMode, equation = "burgers", layers;
  Index interior = 1000, boundary = 200;
};
void fields(PinnForward& o, auto& field) {
  field(kModeOption, o.mode, {kDirectMode, kLearnMode}, "learn: the unknown is a network");
  field("equation", o.equation, {"burgers", "convection"}, "a steepening wave, or a moving one");
  field("layers", o.layers, Choices{}, "widths of the hidden layers; by default those above");
  field("interior", o.interior, between(1, 1e5), "N_Ω, points in which the equation holds");
  field("boundary", o.boundary, between(2, 1e5), "N_∂, points at t = 0 and at the ends of x");
}

// The map (1 + s³)/2 of s = 2 · share − 1 brings a third of uniform numbers to within 2 % of ½.
Real denser_at_half(Real share) { return (1 + std::pow(2 * share - 1, 3)) / 2; }

// Points in Ω first, then those at t = 0, then at the ends; in the validation in the same
// proportion.
void draw_point(const PinnForward& o, const Equation& of, RandomStream& stream, Index b,
                Batch& batch) {
  const Index count = batch.samples(), inside = count * o.interior / (o.interior + o.boundary);
  const bool is_inside = b < inside, is_start = !is_inside && b < (inside + count) / 2;
  const bool is_training = count == o.interior + o.boundary;
  const Real drawn = stream.uniform();
  const Real share = of.steepening > 0 && is_training && is_inside ? denser_at_half(drawn) : drawn;
  const Real x = is_inside || is_start ? of.left + (of.right - of.left) * share
                                       : (share < 0.5 ? of.left : of.right);
  const Real t = is_start ? 0 : stream.uniform();
  const Real u = of.solution(x, t);
  const Real weight =
      std::sqrt(static_cast<Real>(count) / static_cast<Real>(is_inside ? inside : count - inside));
  batch.input.col(b) << x / of.length, t, is_inside ? 1 : 0;
  batch.context.col(b) << (is_inside ? weight : 0), (is_inside ? 0 : weight), u;
  batch.target(0, b) = batch.context(1, b) * u;
}

// ‖u − u*‖/‖u*‖ over the samples in Ω
Real relative_error(BatchRef x, const Batch& batch) {
  const auto is_inside = (batch.context.row(0).array() > 0).cast<Real>();
  const auto u = batch.context.row(2).array();
  return std::sqrt(((x.row(0).array() - u).square() * is_inside).sum() /
                   (u.square() * is_inside).sum());
}

ProblemParts make_pinn_forward(const PinnForward& o, const Draw& draw) {
  require(o.mode == kLearnMode, "pinn-forward has only mode=learn; remove mode=direct");
  const Equation& of = kEquations[o.equation == kEquations[0].name ? 0 : 1];
  const Index points = o.interior + o.boundary;
  ProblemParts parts{.physics = std::make_unique<ForwardResidual>(of),
                     .network = networks::laplacian_perceptron(
                         {.widths = networks::perceptron_widths(
                              "pinn-forward", 2, o.layers.empty() ? of.layers : o.layers),
                          .curved = 1,
                          .shows_gradient = true}),
                     .x_error = relative_error,
                     .x_scale = 1,
                     .samples = {.contexts = 3,
                                 .has_truth = false,
                                 .draw = [o, &of](RandomStream& stream, Index b, Batch& batch) {
                                   draw_point(o, of, stream, b, batch);
                                 }}};
  const Learning learning{.mode = o.mode, .batch = points, .data = points};
  return learn(learning, {.inputs = 3, .outputs = 4}, draw, std::move(parts));
}

}  // namespace

void register_pinn_forward(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "pinn-forward",
       .title = "A wave by a network",
       .group = Group::physics,
       .formula = "L = ½(1/N_Ω Σ r² + 1/N_∂ Σ(u − u*)²),  r = u_t + u u_x − ν u_xx or u_t + β u_x",
       .source = "Urbán, Stefanou, Pons (2025); Kiyani et al. (2025); Rathore, Lei, Frangella, "
                 "Lu, Udell (2024)",
       .note =
           "A physics-informed network; a sample is a point (x, t). The error in x is the "
           "relative L2 error of u on fixed points in Ω. Points are fewer than published and random.",
       .aim = Aim::x,
       .family = "burgers",
       .in_all = false,
       .panels = {{.title = "Relative L2 error of u", .kind = "curve"}}},
      make_pinn_forward));
}

}  // namespace isoline::problems
