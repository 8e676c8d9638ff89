// The sum of amplitudes. Of the half spectrum that is kept, a mode stands for its conjugate too,
// except in the first column and, N being even, in the last.
#include "problems/physics/amplitudes.h"

#include <cmath>
#include <complex>

namespace isoline::problems {

Real Amplitudes::amplitude(Index i, Index j) const {
  return std::abs(fourier_.spectrum()(i, j)) / static_cast<Real>(N_);
}

void Amplitudes::transform(VectorRef y, VectorRef target) const {
  difference_ = y - target;
  fourier_.forward(difference_);
}

Real Amplitudes::value(BatchRef y, BatchRef target) const {
  Real sum = 0;
  for (Index b = 0; b < y.cols(); ++b) {
    transform(y.col(b), target.col(b));
    for (Index j = 0; j < N_; ++j)
      for (Index i = 0; i <= N_ / 2; ++i) {
        const Real of_mode = amplitude(i, j);
        const Real held = of_mode * of_mode < kLeast ? std::sqrt(kLeast) : of_mode;
        sum += (i == 0 || 2 * i == N_ ? 1 : 2) * held;
      }
  }
  return sum / static_cast<Real>(y.cols());
}

// The transpose of the transform turns the phases back into cells.
void Amplitudes::cotangent(BatchRef y, BatchRef target, BatchOut g) const {
  for (Index b = 0; b < y.cols(); ++b) {
    transform(y.col(b), target.col(b));
    for (Index j = 0; j < N_; ++j)
      for (Index i = 0; i <= N_ / 2; ++i) {
        const Real of_mode = amplitude(i, j);
        const bool is_held = of_mode * of_mode < kLeast;
        fourier_.spectrum()(i, j) *= is_held ? 0 : 1 / (of_mode * static_cast<Real>(N_));
      }
    fourier_.inverse(g.col(b));
  }
  g /= static_cast<Real>(y.cols() * N_);
}

// Of |d̂| the second derivative is what is left of a change across the phase, over |d̂|.
void Amplitudes::curvature(BatchRef y, BatchRef target, BatchRef dy, BatchOut dg) const {
  for (Index b = 0; b < y.cols(); ++b) {
    transform(y.col(b), target.col(b));
    held_ = fourier_.spectrum();
    fourier_.forward(dy.col(b));
    for (Index j = 0; j < N_; ++j)
      for (Index i = 0; i <= N_ / 2; ++i) {
        std::complex<Real>& change = fourier_.spectrum()(i, j);
        const std::complex<Real> d = held_(i, j);
        const Real size = std::abs(d), of_mode = size / static_cast<Real>(N_);
        if (of_mode * of_mode < kLeast)
          change = 0;
        else
          change = (change - d * (std::real(std::conj(d) * change) / (size * size))) / size;
      }
    fourier_.inverse(dg.col(b));
  }
  dg /= static_cast<Real>(y.cols() * N_);
}

}  // namespace isoline::problems
