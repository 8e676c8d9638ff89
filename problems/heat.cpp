// Heat flow on a periodic grid of N×N unit cells for νt = 8: ŷ_k = x̂_k e^(−ℓ_k),
// ℓ_k = νt (2π)² |k|², k in cycles per cell. Holl, Koltun, Thuerey (2022), Fig. 6c and the script
// for inverse diffusion, as a direct problem. Its damped inverse of d = y − P(x₀), D = F d:
//
//   s = N e^(−ℓ), σ = 1e-6 ‖d‖ + 1e-8, S = ½ exp(−½|D|²/s²), M = ½ exp(−½|D|²/σ²), p = S/(S + M),
//   α = 2(p − ½) where p ≤ ½ or p ≥ 0.68, else 0;   x = x₀ + F⁻¹(e^(αℓ) D)
//
// so a mode that stands out of the noise σ is deconvolved and one that does not is diffused again.
//
// How far y* can give x* back is a property of the data: J is diagonal in waves, so its best
// spectral cut-off (truncated SVD; Hansen 1998, section 3.2) keeps the modes with ℓ ≤ c. They have
// the rounding error of y*, u‖y*‖ over all N² modes, times e^ℓ; the others stay where the iteration
// starts:
//
//   floor² = min over c of  Σ_{ℓ ≤ c} (u ‖y*‖ e^ℓ / N)² + Σ_{ℓ > c} |F(x₀ − x*)|² / N²,  u = 2⁻⁵³
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/fourier.h"
#include "networks/mean_matched.h"
#include "problems/learning.h"

namespace isoline::problems {

using networks::make_network;
using networks::MeanMatched;
namespace {

struct Options {
  Index N = 64;
  Learning learning{.network = "unet", .batch = 128};
};
void fields(Options& o, auto& field) {
  field("N", o.N, between(2, 1024), "cells along each side");
  fields(o.learning, field);
}

class Heat final : public SelfAdjointPhysics {
 public:
  Heat(Index N, Real noise_floor)
      : N_(N), noise_floor_(noise_floor), fourier_(N, N), ell_(N / 2 + 1, N), gain_(ell_) {
    constexpr Real kDiffusion = 8;  // νt
    for (Index j = 0; j < N; ++j) {
      for (Index i = 0; i <= N / 2; ++i) {
        const Real ki = static_cast<Real>(i), kj = static_cast<Real>(std::min(j, N - j));
        const Real k2 = (ki * ki + kj * kj) / static_cast<Real>(N * N);
        ell_(i, j) = kDiffusion * 4 * std::numbers::pi * std::numbers::pi * k2;
        gain_(i, j) = std::exp(-ell_(i, j)) / fourier_.round_trip();
      }
    }
  }
  Index inputs() const override { return N_ * N_; }
  Index outputs() const override { return N_ * N_; }

  void apply(BatchRef x, BatchOut y) const override {
    for (Index b = 0; b < x.cols(); ++b) {
      fourier_.forward(x.col(b));
      fourier_.spectrum().array() *= gain_.array();
      fourier_.inverse(y.col(b));
    }
  }
  // x becomes what the best cut-off gives without rounding; the error that rounding adds to it is
  // returned. truth, target, start and x are one sample each, (N²).
  Real cut_off(VectorRef truth, VectorRef target, VectorRef start, VectorOut x) const {
    struct Mode {
      Real ell = 0, noise = 0, missing = 0;  // squared norms, of both halves of the spectrum
    };
    const Real cells = fourier_.round_trip();
    constexpr Real kUnit = std::numeric_limits<Real>::epsilon() / 2;
    const Real noise = std::pow(kUnit * target.norm(), 2) / cells;
    x = start - truth;
    fourier_.forward(x);
    auto& D = fourier_.spectrum();
    std::vector<Mode> modes;
    for (Index j = 0; j < D.cols(); ++j)
      for (Index i = 0; i < D.rows(); ++i) {
        const Real count = i == 0 || 2 * i == N_ ? 1 : 2;  // with its conjugate
        modes.push_back({ell_(i, j), count * noise * std::exp(2 * ell_(i, j)),
                         count * std::norm(D(i, j)) / cells});
      }
    std::ranges::sort(modes, std::ranges::greater{}, &Mode::ell);
    for (std::size_t i = modes.size() - 1; i-- > 0;)
      modes[i].noise += modes[i + 1].noise;  // and after
    Mode best = modes.back();
    Real lost = 0, least = std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const bool is_cut =
          i == 0 || modes[i].ell != modes[i - 1].ell;  // modes of one ℓ stay together
      if (is_cut && modes[i].noise + lost < least) {
        least = modes[i].noise + lost;
        best = modes[i];
      }
      lost += modes[i].missing;
    }
    for (Index j = 0; j < D.cols(); ++j)
      for (Index i = 0; i < D.rows(); ++i) D(i, j) *= ell_(i, j) <= best.ell ? 0 : 1 / cells;
    fourier_.inverse(x);
    x += truth;
    return std::sqrt(best.noise);
  }

  Inverse inverse_kind() const override { return Inverse::damped; }
  Index inverse_price() const override { return 2; }  // P(x₀), and as much again to invert
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef, BatchOut x) const override {
    apply(x0, x);
    x = y - x;  // d
    for (Index b = 0; b < y.cols(); ++b) sharpen(x.col(b));
    x += x0;
    return Success::Constant(y.cols(), true);
  }

 private:
  void sharpen(VectorOut d) const {  // d = F⁻¹(e^(αℓ) F d), (N²)
    const Real sigma = 1e-6 * d.norm() + noise_floor_;
    fourier_.forward(d);
    auto& D = fourier_.spectrum();
    for (Index j = 0; j < D.cols(); ++j) {
      for (Index i = 0; i < D.rows(); ++i) {
        const Real ell = ell_(i, j), s = static_cast<Real>(N_) * std::exp(-ell);
        D(i, j) *= std::exp(action(std::abs(D(i, j)), s, sigma) * ell) / fourier_.round_trip();
      }
    }
    fourier_.inverse(d);
  }

  // α in [−1, 1]; the factors ½ of the densities cancel.
  static Real action(Real amplitude, Real s, Real sigma) {
    constexpr Real kOneSigma = 0.68;  // the evidence required to amplify a mode
    const Real S = std::exp(-0.5 * std::pow(amplitude / s, 2));
    const Real M = std::exp(-0.5 * std::pow(amplitude / sigma, 2));
    const Real p = S + M > 0 ? S / (S + M) : 0;
    return p <= 0.5 || p >= kOneSigma ? 2 * (p - 0.5) : 0;
  }

  Index N_;
  Real noise_floor_;
  mutable RealFourier2d fourier_;  // its spectrum is scratch
  Matrix ell_;                     // ℓ, (N/2 + 1, N)
  Matrix gain_;                    // e^(−ℓ) over the factor of a round trip, (N/2 + 1, N)
};

// The floor of σ, from the authors, for repeated use: σ vanishes with d, and rounding errors would
// then pass for evidence. A network's d does not vanish, and they train without it.
constexpr Real kNoiseFloor = 1e-8;

// A sum of 4 to 10 rectangles with edges one cell soft. Lengths are those of a grid of 64, times
// N/64. (N²)
Vector soft_rectangles(Index N, RandomStream& stream) {
  constexpr Index kSlots = 10;  // all are sampled; only the first `count` have a strength
  const Real radius = std::numbers::sqrt2 / 2;  // in cells: the width of a soft edge
  const Real unit = static_cast<Real>(N) / 64;
  const auto count = static_cast<Index>(4 + 7 * stream.uniform());
  Matrix field = Matrix::Zero(N, N);
  for (Index slot = 0; slot < kSlots; ++slot) {
    Eigen::Array2d centre, half;
    for (Real& c : centre) c = unit * stream.uniform(6.4, 57.6);
    for (Real& h : half) h = unit * stream.uniform(0, 10);
    const Real drawn = stream.uniform(), strength = slot < count ? drawn : 0;
    centre = centre.max(half).min(static_cast<Real>(N) - half);
    for (Index j = 0; j < N; ++j) {
      for (Index i = 0; i < N; ++i) {
        const Eigen::Array2d cell(static_cast<Real>(i) + 0.5, static_cast<Real>(j) + 0.5);
        const Real outside = ((cell - centre).abs() - half).maxCoeff();
        field(i, j) += strength * std::clamp(0.5 - outside / radius, 0.0, 1.0);
      }
    }
  }
  return field.reshaped();
}

// A network starts nowhere: the modes that are cut off are 0. What rounding adds is left out, which
// has no place in a sum of absolute values and is less than what is cut off.
Real learned_floor(const Heat& physics, const Batch& batch) {
  Matrix x = batch.truth;
  const Vector nothing = Vector::Zero(x.rows());
  for (Index b = 0; b < x.cols(); ++b)
    physics.cut_off(batch.truth.col(b), batch.target.col(b), nothing, x.col(b));
  return summed_error(x, batch);
}

// The mean of x* is that of y*, which a network is given: x ← N(y*) + mean(y*) − mean(N(y*)).
ProblemParts make_heat(const Options& o, const Draw& draw) {
  const Index N = o.N;
  const Field field{
      .rows = N, .columns = N, .x = {"initial temperature"}, .y = {"final temperature"}};
  if (o.learning.is_on()) {
    const auto physics = std::make_shared<const Heat>(N, 0);
    const NetworkShape shape{.inputs = N * N, .outputs = N * N, .grid = N};
    const auto sample =
        sample_of(physics, [N](RandomStream& stream) { return soft_rectangles(N, stream); });
    return learn(
        o.learning, shape, draw,
        {.physics = std::make_unique<Heat>(N, 0),
         .network = std::make_unique<MeanMatched>(make_network(o.learning.network, shape)),
         .x_error = summed_error,
         .x_floor = [physics](const Batch& batch) { return learned_floor(*physics, batch); },
         .samples = {.validation = 64, .draw = sample},
         .field = field});
  }
  RandomStream stream = draw.stream("target");
  ProblemParts parts =
      from_exact_data(std::make_unique<Heat>(N, kNoiseFloor), soft_rectangles(N, stream), draw);
  parts.field = field;
  const Vector truth = parts.truth->col(0);
  Vector x(truth.size());
  const Real rounding =
      Heat(N, kNoiseFloor).cut_off(truth, parts.target.col(0), parts.start.drawn, x);
  const Real floor = std::hypot((x - truth).norm(), rounding);
  parts.x_floor = [floor](const Batch&) { return floor; };
  return parts;
}

}  // namespace

void register_heat(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "heat",
       .title = "Heat flow backwards",
       .group = Group::physics,
       .formula = "ŷₖ = x̂ₖ exp(−8 (2π)² |k|²),  L = ½‖P(x) − y*‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 6c",
       .note =
           "x* is a sum of soft rectangles from our own random streams, for seed 0, too: no "
           "instance is published; its lengths scale with N/64. The starts of seeds from 1 on "
           "contain noise of 0.1 per cell. The data do not determine most of this noise, so it "
           "bounds the error in x of every method from below. Published curves sum |x − x*| over "
           "cells, and so does mode=learn, which gives the network the mean of x*; the error of "
           "one instance is ‖x − x*‖. The damped inverse has the authors' floor for single "
           "problems, 1e-8. The floor under the error in x is that of the best spectral cut-off: "
           "modes that the rounding of the data hides stay where the iteration starts.",
       .aim = Aim::x,  // P is one to one; how far the data give x back is the floor
       .family = "gaussian-blur",
       .is_linear = true,
       .panels = {{.title = "Fig. 6d: learning curves", .kind = "curve"},
                  {.title = "Fig. 6c: one sample of the validation", .kind = "pictures"},
                  {.title = "Detail in the gradient (watch=spectrum): share of its power at wave "
                            "numbers from 0.1 to 0.2 cycles per cell",
                   .kind = "series",
                   .quantity = "spectrum of ∂L/∂x, 0.1 < k ≤ 0.2"},
                  {.title = "Detail in the update U of SIP, same wave numbers",
                   .kind = "series",
                   .quantity = "spectrum of U, 0.1 < k ≤ 0.2"},
                  {.title = "Detail in the error x* − x, same wave numbers",
                   .kind = "series",
                   .quantity = "spectrum of x* − x, 0.1 < k ≤ 0.2"}}},
      make_heat));
}

}  // namespace isoline::problems
