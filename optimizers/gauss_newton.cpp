// Gauss-Newton: θ ← θ − η J⁺ (y − y*), Gauss (1809); Nocedal, Wright (2006), eq. 10.23. J⁺ by a
// complete orthogonal factorization, never by the normal equations, which would square the
// condition number; of least norm where J lacks rank. The factor 1/√B of r = (y − y*)/√B cancels.
#include <algorithm>
#include <limits>

#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

struct GaussNewton {
  Real rate = 1, cutoff = 0;

  struct State {
    Linearization at;
    Vector residual, step;  // (m·B), (n)
  };
  static void persist(State&, Archive&) {}  // all of it is scratch
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.residual = (s.at.y() - f.target()).reshaped();
    const Matrix& J = s.at.jacobian();
    const Real rounding = kEpsilon * static_cast<Real>(std::max(J.rows(), J.cols()));
    if (!least_squares(J, s.residual, std::max(cutoff, rounding), s.step)) {
      f.claim("the Jacobian or the residual is not finite");
      return Status::stalled;
    }
    theta -= rate * s.step;
    return Status::running;
  }
};

void fields(GaussNewton& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("cutoff", o.cutoff, between(0, 1),
        "pivots up to this share of the first count as zero; at least those within rounding do");
}

}  // namespace

void register_gauss_newton(OptimizerRegistry& registry) {
  registry.add(stepper_entry<GaussNewton>(
      {.name = "gauss-newton",
       .title = "Gauss-Newton",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "θ ← θ − η J⁺ (y − y*)",
       .source = "Gauss (1809); Nocedal, Wright (2006), eq. 10.23",
       .note =
           "Without safeguards. Acts on the residual y − y*, whatever the loss. The Jacobian of a "
           "network in single precision is noise below some 1e-6 of its largest: see cutoff.",
       .needs = {Oracle::forward, Oracle::jacobian},
       .is_input_scale_invariant = true,
       .most_rank = 2048,
       .tunable = {.option = "rate", .below = 5}}));
}

}  // namespace isoline::optimizers
