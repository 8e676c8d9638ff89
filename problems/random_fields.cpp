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

}  // namespace isoline::problems
