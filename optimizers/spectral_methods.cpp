// Methods whose step is V f(σ) Uᵀ w over the stacked Jacobian J = U diag(σ) Vᵀ.
//
// gauss-newton: θ ← θ − η J⁺ (y − y*), Gauss (1809); Nocedal, Wright (2006), eq. 10.23. J⁺ by a
// complete orthogonal factorization, never by the normal equations, which would square the
// condition number; of least norm where J lacks rank. A sparse J of many unknowns is the exception:
// its columns are scaled to length 1, JᵀJ is factorized by sparse Cholesky, and the step is
// corrected by its residual. The factor 1/√B of r = (y − y*)/√B cancels.
// The other factorizations truncate the spectrum of J, not the pivots.
//
// hig: half-inverse gradients, Schnell, Holl, Thuerey (2022): Δθ = −η V f(σ) Uᵀ g, g = ∂L/∂y,
// f(σ) = σ^(−κ). κ = 1 is Gauss-Newton, ½ the published method, −1 gradient descent. Singular
// values not above the cut-off, relative to the largest, are discarded, as published; or, against
// which the book argues, clamped to it. hig-damped is our own: f(σ) = σ/(σ² + μ)^((κ+1)/2) with μ
// as a share of σ₁² is the same for large σ and decays for small ones, as a Tikhonov filter does
// for κ = 1, instead of growing up to a cut-off.
//
// spring: SPRING, Goldshlager, Abrahamsen, Lin (2024), arXiv 2401.10190: the step that the
// regularized least squares of this batch leave nearest to the last one,
//   Δ ← μ Δ₋ − Jᵀ (K + λ)⁻¹ (r + μ J Δ₋),  θ ← θ + η Δ,  K = JJᵀ, r = y − y*,
// so that what the batch says nothing of goes on as it went. λ is a share of the mean diagonal of
// K, or as published with damping-unit=absolute. longest-step is the paper's bound on ‖ηΔ‖, the
// root of its constant C.
#include <algorithm>
#include <limits>

#include "optimizers/differences.h"
#include "optimizers/optimizer.h"
#include "optimizers/sparse_least_squares.h"
#include "optimizers/spectral_step.h"

namespace isoline::optimizers {
namespace {

struct GaussNewton {
  static constexpr bool kIsOnResidual = true;  // w = y − y*, else ∂L/∂y
  Real rate = 1, cutoff = 0;
  std::string factorization = "orthogonal", jacobian = "exact", difference_step;
  KrylovLimits krylov;

  SpectralFilter filter(Index longest) const {
    const Real rounding = std::numeric_limits<Real>::epsilon() * static_cast<Real>(longest);
    return power_filter(1, std::max(cutoff, rounding));
  }
};

struct HalfInverse {
  static constexpr bool kIsOnResidual = false;
  Real rate = 1, kappa = 0.5, cutoff = 1e-6;
  std::string small, factorization = "auto";
  KrylovLimits krylov;

  SpectralFilter filter(Index) const {
    return {.kappa = kappa, .cutoff = cutoff, .clamps = small == "clamp"};
  }
};

struct DampedHalfInverse {
  static constexpr bool kIsOnResidual = false;
  Real rate = 1, kappa = 0.5, damping = 1e-8;
  std::string factorization = "auto";
  KrylovLimits krylov;

  SpectralFilter filter(Index) const { return decaying_filter(kappa, damping); }
};

template <class Options>
struct Spectral : Options {
  struct State {
    Linearization at;
    SpectralStep spectral;
    Matrix w;  // (m, B)
    SparseLeastSquares sparse;
    Vector inverse, scaled, moved;  // (n) D⁻¹, D d; (m) J d
    DifferenceJacobian differences;
  };
  static void persist(State& s, Archive& archive) {
    s.spectral.persist(archive);
    if (Options::kIsOnResidual) s.differences.persist(archive);
  }
  State init(Meter& f, const Vector&) const {
    State s;
    s.spectral = SpectralStep(factorization_named(this->factorization), this->krylov);
    s.spectral.start(f);
    if constexpr (Options::kIsOnResidual) s.differences.take_steps(this->difference_step, f);
    if (f.is_sparse()) s.sparse.start(*f.sparse_pattern());
    return s;
  }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    if constexpr (Options::kIsOnResidual) {
      s.w = s.at.y() - f.target();
      if (this->jacobian != "exact") s.differences.renew(f, theta, this->jacobian, s.at);
    } else {
      s.at.cotangent(s.w);
    }
    if (f.is_sparse()) return step_sparse(f, theta, s);
    const SpectralFilter filter = this->filter(std::max(s.w.size(), theta.size()));
    const bool is_taken = s.spectral.add(f, s.at, filter, s.w.reshaped(), -this->rate, theta);
    return is_taken ? Status::running : Status::stalled;
  }
  Status step_sparse(Meter& f, Vector& theta, State& s) const {
    const Vector& J = s.at.sparse_jacobian();
    s.inverse.resize(theta.size());
    f.sparse_pattern()->squared_columns(J.data(), s.inverse);
    s.inverse = (s.inverse.array() > 0).select(s.inverse.cwiseSqrt().cwiseInverse(), 0);
    s.sparse.set(J, s.inverse);
    if (!s.sparse.solve(0, s.w.col(0), s.scaled, s.moved)) return Status::stalled;
    theta -= this->rate * s.scaled.cwiseProduct(s.inverse);
    return Status::running;
  }
};

template <class Options>
OptimizerEntry spectral_entry(OptimizerEntry entry) {
  entry.needs_for = [](const OptionValues& options, const Problem& problem) {
    const auto o = read_options<Options>(options);
    if (options.text("jacobian", "exact") != "exact") return OracleSet{Oracle::forward};
    if (o.factorization == "orthogonal" && is_solved_sparse(problem))
      return OracleSet{Oracle::forward, Oracle::sparse_jacobian};
    return needs_of(factorization_named(o.factorization), o.filter(0), problem);
  };
  entry.objection = [](const OptionValues& options, const Problem& problem) {
    return objection_to(factorization_named(read_options<Options>(options).factorization), problem);
  };
  return stepper_entry<Spectral<Options>>(std::move(entry));
}

void fields(GaussNewton& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("cutoff", o.cutoff, between(0, 1),
        "pivots or singular values up to this share of the largest one count as zero, and so do "
        "those within rounding");
  field("factorization", o.factorization, Choices{"orthogonal", "svd", "qr", "gram", "layers"},
        "how J⁺ is applied: by a complete orthogonal factorization with pivots, or by sparse "
        "Cholesky of JᵀJ with corrections where J is sparse and has 256 unknowns or more; by the "
        "thin SVD of J; by QR and the SVD of R; by the smaller Gram matrix of J; or by JJᵀ formed "
        "layer by layer");
  field("jacobian", o.jacobian, kJacobians, kJacobianHelp);
  field("difference-step", o.difference_step, {}, kStepHelp);
}

void first_fields(auto& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("kappa", o.kappa, between(-1, 1), "exponent κ of the inversion");
}
void way_fields(auto& o, auto& field) {
  field("factorization", o.factorization,
        Choices{"auto", "svd", "qr", "gram", "layers", "split", "lanczos"},
        "how the step is computed: by the thin SVD of J; by QR and the SVD of R; by the smaller "
        "Gram matrix of J; by JJᵀ formed layer by layer, or that and again from the part of J that "
        "belongs to its small eigenvalues; or by products with J and Jᵀ alone; "
        "auto: by size and accuracy, never by products");
  field("krylov-tolerance", o.krylov.tolerance, between(0, 1),
        "of factorization=lanczos: where to end, as an estimate of the relative error of the step");
  field("krylov-vectors", o.krylov.vectors, between(1, 1e5),
        "of factorization=lanczos: most vectors kept, within 512 MiB");
}

void fields(HalfInverse& o, auto& field) {
  first_fields(o, field);
  field("cutoff", o.cutoff, between(0, 1),
        "singular values up to this share of the largest are discarded");
  field("small", o.small, Choices{"", "clamp"}, "clamp: they count as the cut-off instead");
  way_fields(o, field);
}

void fields(DampedHalfInverse& o, auto& field) {
  first_fields(o, field);
  field("damping", o.damping, above(0), "damping μ, as a share of the largest σ²");
  way_fields(o, field);
}

constexpr Index kMostRank = 4000;  // of a Cholesky decomposition that takes seconds

struct Spring {
  Real rate = 1, momentum = 0.9, damping = 1e-3, longest_step = 0;
  std::string damping_unit = "mean", line_search, factorization;

  struct State {
    Linearization at;
    SpectralStep spectral;
    Vector step;       // (n) Δ
    Vector candidate;  // (n)
    Matrix pushed;     // (m, B) J Δ₋
    Vector residual;   // (m·B)
  };
  static void persist(State& s, Archive& archive) {
    s.spectral.persist(archive);
    archive(s.step);
  }
  State init(Meter&, const Vector& theta) const {
    State s;
    s.spectral = SpectralStep(wanted());
    s.step = Vector::Zero(theta.size());
    return s;
  }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.step *= momentum;
    s.pushed.resize(s.at.y().rows(), s.at.y().cols());
    s.at.pushforward(s.step, s.pushed);
    s.residual = (s.at.y() - f.target() + s.pushed).reshaped();
    const SpectralFilter filter = damping_unit == "absolute" ? absolute_filter(damping, f.samples())
                                                             : tikhonov_filter(damping);
    if (!s.spectral.add(f, s.at, filter, s.residual, -1, s.step)) return Status::stalled;
    Real length = rate;
    if (!line_search.empty()) length = length_on_grid(f, theta, s.step, rate, s.candidate);
    if (longest_step > 0) length = std::min(length, longest_step / s.step.norm());
    if (length == 0) return Status::stalled;
    theta += length * s.step;
    return Status::running;
  }
  Factorization wanted() const {
    return factorization.empty() ? Factorization::automatic : factorization_named(factorization);
  }
};

void fields(Spring& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("momentum", o.momentum, between(0, 1), "share μ of the last step");
  field("damping", o.damping, above(0), "damping λ, in its unit");
  field("damping-unit", o.damping_unit, Choices{"mean", "absolute"},
        "mean: λ is a share of the mean diagonal of JJᵀ; absolute: λ is added to JJᵀ/B");
  field("longest-step", o.longest_step, at_least(0), "bound on ‖η Δ‖; 0: none");
  field(
      "line-search", o.line_search, Choices{"", "grid"},
      "grid: of η, η/2, …, η/2³⁰, the step length with the lowest loss on the samples of the step");
  field("factorization", o.factorization, Choices{"", "cholesky"},
        "how the step is computed; by default by size and accuracy; cholesky: always by that of "
        "JJᵀ, as published, or of JᵀJ if it is smaller");
}

OracleSet needs_of_spring(const OptionValues& options, const Problem& problem) {
  OracleSet needs = needs_of(read_options<Spring>(options).wanted(), tikhonov_filter(1), problem);
  needs.add(Oracle::pushforward);
  return needs;
}

}  // namespace

void register_spectral_methods(OptimizerRegistry& registry) {
  registry.add(spectral_entry<GaussNewton>(
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
       .tunable = {.option = "rate", .below = 5}}));
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
           "networks of dense layers formed layer by layer, and split in two if needed). Otherwise "
           "uses QR, and with small=clamp the SVD of J. factorization=lanczos is for Jacobians too "
           "large for all of these.",
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
  registry.add(stepper_entry<Spring>(
      {.name = "spring",
       .title = "SPRING",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "Δ ← μ Δ − Jᵀ (JJᵀ + λ)⁻¹ (y − y* + μ J Δ),  θ ← θ + η Δ",
       .source = "Goldshlager, Abrahamsen, Lin (2024)",
       .note = "Damped Gauss-Newton with projected momentum. By default, λ is relative to the mean "
               "diagonal of JJᵀ, and the length of a step has no bound; the paper's λ is absolute, "
               "and its bound is √0.001.",
       .needs = {Oracle::forward, Oracle::pushforward},
       .most_rank = kMostRank,
       .tunable = {.option = "rate", .below = 4},
       .needs_for = needs_of_spring}));
}

}  // namespace isoline::optimizers
