// Half-inverse gradients, Schnell, Holl, Thuerey (2022): Δθ = −η V f(σ) Uᵀ g over the stacked
// Jacobian J = U diag(σ) Vᵀ and g = ∂L/∂y, f(σ) = σ^(−κ). κ = 1 is Gauss-Newton, ½ the published
// method, −1 gradient descent. Singular values not above the cut-off, relative to the largest, are
// discarded, as published; or, against which the book argues, clamped to it. The damped form is our
// own: f(σ) = σ/(σ² + μ)^((κ+1)/2) with μ as a share of σ₁² is the same for large σ and decays for
// small ones, as a Tikhonov filter does for κ = 1, instead of growing up to a cut-off.
#include "optimizers/optimizer.h"
#include "optimizers/spectral_step.h"

namespace isoline::optimizers {
namespace {

struct HalfInverse {
  Real rate = 1, kappa = 0.5, cutoff = 1e-6;
  std::string small, way = "auto";
  KrylovLimits krylov;

  SpectralFilter filter() const {
    return small == "clamp" ? clamped_power_filter(kappa, cutoff) : power_filter(kappa, cutoff);
  }
};

struct DampedHalfInverse {
  Real rate = 1, kappa = 0.5, damping = 1e-8;
  std::string way = "auto";
  KrylovLimits krylov;

  SpectralFilter filter() const { return decaying_filter(kappa, damping); }
};

// Δθ = −η V f(σ) Uᵀ g for any of them.
template <class Options>
struct Spectral : Options {
  struct State {
    Linearization at;
    SpectralStep spectral;
    Matrix g;  // (m, B)
  };
  static void persist(State& s, Archive& archive) { s.spectral.persist(archive); }
  State init(Meter& f, const Vector&) const {
    State s{.at = {}, .spectral = SpectralStep(way_named(this->way), this->krylov), .g = {}};
    s.spectral.start(f);
    return s;
  }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.cotangent(s.g);
    const bool is_taken =
        s.spectral.add(f, s.at, this->filter(), s.g.reshaped(), -this->rate, theta);
    return is_taken ? Status::running : Status::stalled;
  }
};

void way_fields(std::string& way, KrylovLimits& krylov, auto& field) {
  field("way", way, Choices{"auto", "svd", "qr", "gram", "layers", "split", "lanczos"},
        "how the step is computed: by the thin SVD of J; by QR and the SVD of R; by the smaller "
        "Gram matrix of J; by JJᵀ formed layer by layer, or that and again from the part of J that "
        "belongs to its small eigenvalues; or by products with J and Jᵀ alone; "
        "auto: by size and accuracy, never by products");
  field("krylov-tolerance", krylov.tolerance, between(0, 1),
        "of way=lanczos: where to end, as an estimate of the relative error of the step");
  field("krylov-vectors", krylov.vectors, between(1, 1e5),
        "of way=lanczos: most vectors kept, within 512 MiB");
}

void fields(HalfInverse& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("kappa", o.kappa, between(-1, 1), "exponent κ of the inversion");
  field("cutoff", o.cutoff, between(0, 1),
        "singular values up to this share of the largest are discarded");
  field("small", o.small, Choices{"", "clamp"}, "clamp: they count as the cut-off instead");
  way_fields(o.way, o.krylov, field);
}

void fields(DampedHalfInverse& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("kappa", o.kappa, between(-1, 1), "exponent κ of the inversion");
  field("damping", o.damping, above(0), "damping μ, as a share of the largest σ²");
  way_fields(o.way, o.krylov, field);
}

template <class Options>
OptimizerEntry spectral_entry(OptimizerEntry entry) {
  entry.needs_for = [](const OptionValues& options, const Problem& problem) {
    const auto o = read_options<Options>(options);
    return needs_of(way_named(o.way), o.filter(), problem);
  };
  entry.objection = [](const OptionValues& options, const Problem& problem) {
    return objection_to(way_named(read_options<Options>(options).way), problem);
  };
  return stepper_entry<Spectral<Options>>(std::move(entry));
}

}  // namespace

void register_hig(OptimizerRegistry& registry) {
  registry.add(spectral_entry<HalfInverse>(
      {.name = "hig",
       .title = "Half-inverse gradients",
       .family = Family::inversion,
       .kind = Kind::half_inverse,
       .formula = "θ ← θ − η V Λ^(−κ) Uᵀ g,  J = U Λ Vᵀ,  g = ∂L/∂y",
       .source = "Schnell, Holl, Thuerey (2022)",
       .note =
           "Scales with the loss as c, with y as s^(1−κ), with B equal samples as B^(−(1+κ)/2). "
           "Uses a Gram matrix if the cut-off is at least 1e-7 and the step loses no digits (for "
           "networks of dense layers formed layer by layer, and split in two if needed). "
           "Otherwise uses QR, and with small=clamp the SVD of J. way=lanczos is for Jacobians "
           "too large for all "
           "of these.",
       .needs = {Oracle::forward},
       .most_rank = 2048,
       .tunable = {.option = "rate", .below = 4}}));
  registry.add(spectral_entry<DampedHalfInverse>(
      {.name = "hig-damped",
       .title = "Half-inverse gradients, damped",
       .family = Family::inversion,
       .kind = Kind::half_inverse,
       .formula = "θ ← θ − η V Λ (Λ² + μ)^(−(κ+1)/2) Uᵀ g,  J = U Λ Vᵀ,  g = ∂L/∂y",
       .source = "after Schnell, Holl, Thuerey (2022); μ as in Tikhonov's filter",
       .note =
           "Our own: the half-inverse decays where singular values vanish, where the published "
           "one grows up to its cut-off. With κ = 1 it is the Levenberg-Marquardt step with fixed "
           "damping. Scales as hig does.",
       .needs = {Oracle::forward},
       .most_rank = 2048,
       .tunable = {.option = "rate", .below = 4}}));
}

}  // namespace isoline::optimizers
