// L = (1/B) Σ Σ_k √max(|d̂_k|²/N², 1e-5), d̂ the transform of y − y*, N cells a side: the sum of the
// amplitudes of the modes, the published loss of the fluid experiment; the square, ½ Σ |d̂_k|²/N²,
// is ½‖y − y*‖².
#pragma once

#include "core/fourier.h"
#include "problems/loss.h"

namespace isoline::problems {

class Amplitudes final : public Loss {
 public:
  explicit Amplitudes(Index N) : N_(N), fourier_(N, N), difference_(N * N) {}
  bool is_least_squares() const override { return false; }
  Real value(BatchRef y, BatchRef target) const override;
  void cotangent(BatchRef y, BatchRef target, BatchOut g) const override;
  void curvature(BatchRef y, BatchRef target, BatchRef dy, BatchOut dg) const override;

 private:
  static constexpr Real kLeast = 1e-5;     // of a squared amplitude
  Real amplitude(Index i, Index j) const;  // |d̂|/N of the spectrum now held
  void transform(VectorRef y, VectorRef target) const;

  Index N_;
  mutable RealFourier2d fourier_;  // its spectrum is scratch, as is this
  mutable Vector difference_;      // (N²)
  mutable Eigen::MatrixXcd held_;  // (N/2 + 1, N)
};

}  // namespace isoline::problems
