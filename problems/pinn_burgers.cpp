// The viscosity of a flow from noisy measurements, by a network that satisfies Burgers' equation:
//
//   u_t + u u_x = ν u_xx,  −1 < x < 1, 0 < t < 1,  u(x, 0) = −sin πx,  u = N(x, t; θ),  ν = e^c,
//   L = 1/B Σ ½ ((u − u*)² + (u_t + u u_x − ν u_xx)²),
//
// Raissi, Perdikaris, Karniadakis (2019), arXiv 1711.10566, section 3.1: no boundary and no initial
// values, but B = 2,000 points (x, t) in which u is measured with noise and the equation shall
// hold. The unknowns are the weights of a perceptron of hyperbolic tangents in double precision,
// and c. Deviation: the coefficient of u u_x is known, there are four hidden layers of 20 in place
// of eight, and t runs to 1 as there, but u* is the closed form of Cole and Hopf. A sample maps to
// the numbers (u, u_x, u_t, u_xx, c). The error in x is ‖u − u*‖/‖u*‖ over the validation, and the
// error of ν is a series of the record.
#include <cmath>
#include <memory>
#include <numbers>

#include "networks/laplacian_perceptron.h"
#include "problems/cole_hopf.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

// (u, u_x, u_t, u_xx, c) ↦ (u, u_t + u u_x − e^c u_xx)
class BurgersResidual final : public Physics {
 public:
  Index inputs() const override { return 5; }
  Index outputs() const override { return 2; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override {
    for (Index b = 0; b < x.cols(); ++b) {
      const Sample at(x, b);
      y(0, b) = at.u;
      y(1, b) = at.u_t + at.u * at.u_x - at.viscosity * at.u_xx;
    }
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    for (Index b = 0; b < v.cols(); ++b) {
      const Sample at(w.x, b);
      Jv(0, b) = v(0, b);
      Jv(1, b) = v(2, b) + at.u * v(1, b) + at.u_x * v(0, b) -
                 at.viscosity * (v(3, b) + at.u_xx * v(4, b));
    }
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    for (Index b = 0; b < u.cols(); ++b) {
      const Sample at(w.x, b);
      const Real f = u(1, b);
      JTu.col(b) << u(0, b) + f * at.u_x, f * at.u, f, -f * at.viscosity,
          -f * at.viscosity * at.u_xx;
    }
  }

 private:
  struct Sample {
    Sample(BatchRef x, Index b)
        : u(x(0, b)), u_x(x(1, b)), u_t(x(2, b)), u_xx(x(3, b)), viscosity(std::exp(x(4, b))) {}
    Real u, u_x, u_t, u_xx, viscosity;
  };
};

struct PinnBurgers {
  std::string mode = kLearnMode, layers = "20-20-20-20";
  Index points = 2000;
  Real noise = 0.01, viscosity = 0.01 / std::numbers::pi, start_viscosity = 0.1;
};
void fields(PinnBurgers& o, auto& field) {
  field(kModeOption, o.mode, {kDirectMode, kLearnMode}, "learn: the unknown is a network");
  field("layers", o.layers, Choices{}, "widths of the hidden layers");
  field("points", o.points, between(1, 1e5), "measurements of u, in which the equation holds, too");
  field("sigma", o.noise, between(0, 10), "standard deviation of the noise in u*");
  field("viscosity", o.viscosity, between(1e-3, 10), "viscosity ν that made the data");
  field("start-viscosity", o.start_viscosity, between(1e-6, 10), "viscosity ν of the start");
}

void draw_point(const PinnBurgers& o, RandomStream& stream, Index b, Batch& batch) {
  const Real x = stream.uniform(-1, 1), t = stream.uniform();
  const Real u = cole_hopf(x, t, o.viscosity);
  batch.input.col(b) << x, t, 1;
  batch.context(0, b) = u;
  batch.target.col(b) << u + o.noise * stream.normal_vector(1)[0], 0;
}

Series error_of_viscosity(Real viscosity) {
  return {.names = {"relative error of ν"},
          .evaluate = [viscosity](const Problem&, VectorRef theta, Point&, VectorOut values) {
            values[0] = std::abs(std::exp(theta[theta.size() - 1]) / viscosity - 1);
          }};
}

ProblemParts make_pinn_burgers(const PinnBurgers& o, const Draw& draw) {
  require(o.mode == kLearnMode, "pinn-burgers has only mode=learn; remove mode=direct");
  ProblemParts parts{.physics = std::make_unique<BurgersResidual>(),
                     .network = networks::laplacian_perceptron(
                         {.widths = networks::perceptron_widths("pinn-burgers", 2, o.layers),
                          .curved = 1,
                          .shows_gradient = true,
                          .constants = Vector::Constant(1, std::log(o.start_viscosity))}),
                     .x_error =
                         [](BatchRef x, const Batch& batch) {
                           return (x.row(0) - batch.context.row(0)).norm() /
                                  batch.context.row(0).norm();
                         },
                     .x_scale = 1,
                     .samples = {.contexts = 1,
                                 .has_truth = false,
                                 .draw = [o](RandomStream& stream, Index b,
                                             Batch& batch) { draw_point(o, stream, b, batch); }},
                     .series = error_of_viscosity(o.viscosity)};
  const Learning learning{.mode = o.mode, .batch = o.points, .data = o.points};
  return learn(learning, {.inputs = 3, .outputs = 5}, draw, std::move(parts));
}

}  // namespace

void register_pinn_burgers(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "pinn-burgers",
       .title = "Viscosity of a flow by a network",
       .group = Group::physics,
       .formula = "L = 1/B Σ ½((u − u*)² + (u_t + u u_x − ν u_xx)²),  u = N(x, t; θ)",
       .source = "Raissi, Perdikaris, Karniadakis (2019), section 3.1",
       .note = "A physics-informed network with an unknown coefficient; a sample is a point in "
               "which u is measured with noise. The last unknown is log ν. The error in x is the "
               "relative L2 error of u on points without noise; a series of the record is the "
               "relative error of ν.",
       .aim = Aim::x,
       .family = "burgers",
       .in_all = false,
       .panels =
           {{.title = "Relative L2 error of u", .kind = "curve"},
            {.title = "Relative error of ν", .kind = "series", .quantity = "relative error of ν"}}},
      make_pinn_burgers));
}

}  // namespace isoline::problems
