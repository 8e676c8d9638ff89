// Half-inverse gradients, Schnell, Holl, Thuerey (2022): Δθ = −η V Λ^(−κ) Uᵀ g over the
// stacked Jacobian J = U Λ Vᵀ and g = ∂L/∂y. κ = 1 is Gauss-Newton, ½ the published method, −1
// gradient descent. Singular values not above the cut-off, relative to the largest, are discarded.
#include <cmath>

#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline {
namespace {

struct HalfInverse {
  Real rate = 1, kappa = 0.5, cutoff = 1e-6;

  struct State {
    Linearization at;
    Svd svd;
    Matrix g;      // (m, B)
    Vector along;  // (r), in the singular basis
  };
  static void persist(State&, Archive&) {}  // all of it is scratch
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.cotangent(s.g);
    if (!thin_svd(s.at.jacobian(), s.svd)) {
      f.claim("the Jacobian has no singular values in finite numbers");
      return Status::stalled;
    }
    s.along.noalias() = s.svd.U.transpose() * s.g.reshaped();
    for (Index i = 0; i < s.along.size(); ++i) s.along[i] *= filter(s.svd.sigma[i], s.svd.sigma[0]);
    theta.noalias() -= rate * s.svd.Vt.transpose() * s.along;
    return Status::running;
  }

  Real filter(Real sigma, Real largest) const {
    return sigma > cutoff * largest ? std::pow(sigma, -kappa) : 0;
  }
};

void fields(HalfInverse& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("kappa", o.kappa, between(-1, 1), "exponent κ of the inversion");
  field("cutoff", o.cutoff, between(0, 1),
        "singular values up to this share of the largest are discarded");
}

}  // namespace

void register_hig(OptimizerRegistry& registry) {
  registry.add(stepper_entry<HalfInverse>(
      {.name = "hig",
       .title = "Half-inverse gradients",
       .family = Family::inversion,
       .formula = "θ ← θ − η V Λ^(−κ) Uᵀ g,  J = U Λ Vᵀ,  g = ∂L/∂y",
       .source = "Schnell, Holl, Thuerey (2022)",
       .note =
           "Scales with the loss as c, with y as s^(1−κ), with B equal samples as B^(−(1+κ)/2).",
       .needs = {Oracle::forward, Oracle::jacobian},
       .most_rank = 2048}));
}

}  // namespace isoline
