// The weights under which two markers are compared, by mode n of the periodic domain:
// w = exp(−½ (1.25 |n|)²), 0 for the mean; Holl, Koltun, Thuerey (2022), published scripts, there
// exp(−½ |k|² 80²) with k in cycles a cell of 64. Only the lowest modes count: 0.458 for |n| = 1,
// 0.044 for 2, 0.00088 for 3.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/fourier.h"

namespace isoline::problems {

// Owns its work space: one a thread.
class LowPass {
 public:
  explicit LowPass(Index N) : fourier_(N, N), weights_(N / 2 + 1, N) {
    for (Index j = 0; j < N; ++j)
      for (Index i = 0; i <= N / 2; ++i) {
        const Real ni = static_cast<Real>(i), nj = static_cast<Real>(std::min(j, N - j));
        constexpr Real kWidth = 1.25;
        weights_(i, j) = std::exp(-0.5 * kWidth * kWidth * (ni * ni + nj * nj)) / norm(N);
      }
    weights_(0, 0) = 0;
  }

  // out = N F⁻¹ w F q, of which ‖out‖² = Σ w² |F q|². Symmetric; `out` may be q.
  void apply(VectorRef q, VectorOut out) {
    fourier_.forward(q);
    fourier_.spectrum().array() *= weights_.array();
    fourier_.inverse(out);
  }

 private:
  static Real norm(Index N) { return static_cast<Real>(N); }  // of a round trip, over N

  RealFourier2d fourier_;
  Matrix weights_;  // (N/2 + 1, N) over the norm
};

}  // namespace isoline::problems
