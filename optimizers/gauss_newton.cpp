// Gauss-Newton: θ ← θ − η J⁺ (y − y*), Gauss (1809); Nocedal, Wright (2006), eq. 10.23. J⁺ by a
// complete orthogonal factorization, never by the normal equations, which would square the
// condition number; of least norm where J lacks rank. The factor 1/√B of r = (y − y*)/√B cancels.
// The other ways truncate the spectrum of J, not the pivots.
#include <algorithm>
#include <limits>

#include "optimizers/optimizer.h"
#include "optimizers/spectral_step.h"

namespace isoline::optimizers {
namespace {

constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

struct GaussNewton {
  Real rate = 1, cutoff = 0;
  std::string way = "orthogonal";

  struct State {
    Linearization at;
    SpectralStep spectral;
    Vector residual;  // (m·B)
  };
  static void persist(State& s, Archive& archive) { s.spectral.persist(archive); }
  State init(Meter&, const Vector&) const {
    return {.at = {}, .spectral = SpectralStep(way_named(way)), .residual = {}};
  }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.residual = (s.at.y() - f.target()).reshaped();
    const Real rounding = kEpsilon * static_cast<Real>(std::max(s.residual.size(), theta.size()));
    const auto filter = truncated_inverse_filter(std::max(cutoff, rounding));
    const bool is_taken = s.spectral.add(f, s.at, filter, s.residual, -rate, theta);
    return is_taken ? Status::running : Status::stalled;
  }
};

void fields(GaussNewton& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("cutoff", o.cutoff, between(0, 1),
        "pivots, or singular values, up to this share of the first count as zero; at least those "
        "within rounding do");
  field("way", o.way, Choices{"orthogonal", "svd", "qr", "gram", "layers"},
        "how J⁺ is applied: by a complete orthogonal factorization with pivots; by the thin SVD "
        "of J; by QR and the SVD of R; by the smaller Gram matrix of J; or by JJᵀ formed layer by "
        "layer");
}

}  // namespace

void register_gauss_newton(OptimizerRegistry& registry) {
  OptimizerEntry entry = stepper_entry<GaussNewton>(
      {.name = "gauss-newton",
       .title = "Gauss-Newton",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "θ ← θ − η J⁺ (y − y*)",
       .source = "Gauss (1809); Nocedal, Wright (2006), eq. 10.23",
       .note = "Without safeguards. Acts on the residual y − y*, whatever the loss. In single "
               "precision, singular values of a network's Jacobian below about 1e-6 of the largest "
               "are noise: see cutoff.",
       .needs = {Oracle::forward},
       .is_input_scale_invariant = true,
       .most_rank = 2048,
       .tunable = {.option = "rate", .below = 5}});
  entry.needs_for = [](const OptionValues& options, const Problem& problem) {
    return needs_of(way_named(options.text("way")), truncated_inverse_filter(0), problem);
  };
  entry.objection = [](const OptionValues& options, const Problem& problem) {
    return objection_to(way_named(options.text("way")), problem);
  };
  registry.add(std::move(entry));
}

}  // namespace isoline::optimizers
