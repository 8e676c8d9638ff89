// Random fields on a grid: the generators of Holl, Koltun, Thuerey (2022), published scripts for
// Poisson and heat, with the noise and the masks as PhiFlow 2.2.3 defines them. The streams are
// our own, so the fields have the same distribution but not the same numbers.
#include "problems/random_fields.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/fourier.h"

namespace isoline::problems {

// PhiFlow filters complex white noise and keeps the real part. The filter is even in n, so that is
// real white noise, filtered.
Vector smooth_noise(Index N, Real scale, Real smoothness, RandomStream& stream) {
  constexpr Real kLowest = 0.1;  // |κ|² of the coarsest structure let through
  Vector field = stream.normal_vector(N * N);
  RealFourier2d fourier(N, N);
  fourier.forward(field);
  for (Index j = 0; j < N; ++j) {
    for (Index i = 0; i <= N / 2; ++i) {
      const Real ni = static_cast<Real>(i), nj = static_cast<Real>(std::min(j, N - j));
      const Real kappa2 = (ni * ni + nj * nj) * std::pow(scale / static_cast<Real>(N), 2);
      fourier.spectrum()(i, j) *= kappa2 > kLowest ? std::pow(kappa2, -smoothness) : 0;
    }
  }
  fourier.inverse(field);
  field.array() -= field.mean();
  return field * (std::sqrt(static_cast<Real>(N * N)) / field.norm());
}

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

}  // namespace isoline::problems
