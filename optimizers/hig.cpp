// Half-inverse gradients, Schnell, Holl, Thuerey (2022): Δθ = −η V Λ^(−κ) Uᵀ g over the
// stacked Jacobian J = U Λ Vᵀ and g = ∂L/∂y. κ = 1 is Gauss-Newton, ½ the published method, −1
// gradient descent. Singular values not above the cut-off, relative to the largest, are discarded,
// as published; or, against which the book argues, clamped to it. Where the cut-off is far above
// rounding, by the smaller Gram matrix, whose eigenvalues are σ²: Δθ = −η V Λ^(−κ−1) Vᵀ Jᵀ g from
// JᵀJ, or −η Jᵀ U Λ^(−κ−1) Uᵀ g from JJᵀ; else by the SVD of J.
#include <algorithm>
#include <cmath>

#include "core/decompose.h"
#include "core/product.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

// Squared, σ is known to about 1e-8 of the largest.
constexpr Real kLeastCutoffOfGram = 1e-7;

struct HalfInverse {
  Real rate = 1, kappa = 0.5, cutoff = 1e-6;
  std::string small;

  struct State {
    Linearization at;
    Svd svd;
    Matrix gram;  // (r, r), r = min(m·B, n)
    SymmetricEigen eigen;
    Matrix g;                     // (m, B)
    Vector right, along, result;  // (r), in the singular basis, and back
  };
  static void persist(State&, Archive&) {}  // all of it is scratch
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.cotangent(s.g);
    const Matrix& J = s.at.jacobian();
    const bool is_by_gram = cutoff >= kLeastCutoffOfGram && small.empty();
    const bool is_known = is_by_gram ? step_by_gram(J, theta, s) : step_by_svd(J, theta, s);
    if (is_known) return Status::running;
    f.claim("the Jacobian has no singular values in finite numbers");
    return Status::stalled;
  }

  bool step_by_gram(const Matrix& J, Vector& theta, State& s) const {
    const bool is_wide = J.rows() < J.cols();
    const Index r = is_wide ? J.rows() : J.cols();
    s.gram.resize(r, r);
    product(is_wide ? Form::A_BH : Form::AH_B, J, J, s.gram);
    if (!symmetric_eigen(s.gram, s.eigen)) return false;
    if (is_wide)
      s.right = s.g.reshaped();
    else
      s.right.noalias() = J.transpose() * s.g.reshaped();
    s.along.noalias() = s.eigen.V.transpose() * s.right;
    const Real largest = std::sqrt(std::max(s.eigen.lambda[r - 1], Real(0)));
    for (Index i = 0; i < r; ++i)
      s.along[i] *= filter(std::sqrt(std::max(s.eigen.lambda[i], Real(0))), largest, kappa + 1);
    s.result.noalias() = s.eigen.V * s.along;
    if (is_wide)
      theta.noalias() -= rate * (J.transpose() * s.result);
    else
      theta -= rate * s.result;
    return true;
  }

  bool step_by_svd(const Matrix& J, Vector& theta, State& s) const {
    if (!thin_svd(J, s.svd)) return false;
    s.along.noalias() = s.svd.U.transpose() * s.g.reshaped();
    for (Index i = 0; i < s.along.size(); ++i)
      s.along[i] *= filter(s.svd.sigma[i], s.svd.sigma[0], kappa);
    theta.noalias() -= rate * s.svd.Vt.transpose() * s.along;
    return true;
  }

  Real filter(Real sigma, Real largest, Real exponent) const {
    if (small == "clamp") return std::pow(std::max(sigma, cutoff * largest), -exponent);
    return sigma > cutoff * largest ? std::pow(sigma, -exponent) : 0;
  }
};

void fields(HalfInverse& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("kappa", o.kappa, between(-1, 1), "exponent κ of the inversion");
  field("cutoff", o.cutoff, between(0, 1),
        "singular values up to this share of the largest are discarded");
  field("small", o.small, Choices{"", "clamp"}, "clamp: they count as the cut-off instead");
}

}  // namespace

void register_hig(OptimizerRegistry& registry) {
  registry.add(stepper_entry<HalfInverse>(
      {.name = "hig",
       .title = "Half-inverse gradients",
       .family = Family::inversion,
       .kind = Kind::half_inverse,
       .formula = "θ ← θ − η V Λ^(−κ) Uᵀ g,  J = U Λ Vᵀ,  g = ∂L/∂y",
       .source = "Schnell, Holl, Thuerey (2022)",
       .note =
           "Scales with the loss as c, with y as s^(1−κ), with B equal samples as B^(−(1+κ)/2). "
           "By the smaller Gram matrix for cut-offs of 1e-7 and more, else, and with small=clamp, by "
           "the SVD of J.",
       .needs = {Oracle::forward, Oracle::jacobian},
       .most_rank = 2048,
       .tunable = {.option = "rate", .below = 4}}));
}

}  // namespace isoline::optimizers
