// Fast transforms of real grids (rows, columns) given as one column-major column: the only door to
// FFTW. A transform owns its plans and its spectrum, is unnormalized, and allocates nothing once
// made. The same plan is executed always, so equal input gives equal bits wherever it lies.
#pragma once

#include <memory>

#include "core/array.h"

struct fftw_plan_s;  // FFTW's own name for a plan: its header stays inside fourier.cpp

namespace isoline {

struct DestroyPlan {
  void operator()(fftw_plan_s* plan) const;
};
using FourierPlan = std::unique_ptr<fftw_plan_s, DestroyPlan>;

// X_kl = Σ x_ij e^(−2πi (ik/rows + jl/columns)) for k ≤ rows/2; the other half is its conjugate.
class RealFourier2d {
 public:
  RealFourier2d(Index rows, Index columns);

  void forward(VectorRef grid);  // spectrum = F grid
  void inverse(VectorOut grid);  // grid = round_trip() F⁻¹ spectrum, which is destroyed
  auto& spectrum() { return spectrum_; }
  Real round_trip() const { return static_cast<Real>(grid_.size()); }

 private:
  Eigen::MatrixXcd spectrum_;  // (rows/2 + 1, columns)
  Vector grid_;                // (rows·columns) stands in for a caller's array that is misaligned
  FourierPlan forward_, inverse_;
};

// X_kl = 4 Σ x_ij sin(π(i+1)(k+1)/(rows+1)) sin(π(j+1)(l+1)/(columns+1)), the DST-I, its own
// inverse but for a factor.
class SineTransform2d {
 public:
  SineTransform2d(Index rows, Index columns);

  void forward(VectorRef grid);  // spectrum = S grid
  void inverse(VectorOut grid);  // grid = S spectrum = round_trip() S⁻¹ spectrum
  auto& spectrum() { return spectrum_; }
  Real round_trip() const {
    return static_cast<Real>(4 * (spectrum_.rows() + 1) * (spectrum_.cols() + 1));
  }

 private:
  Matrix spectrum_;  // (rows, columns)
  Vector grid_;      // (rows·columns) stands in for a caller's array that is misaligned
  FourierPlan forward_, inverse_;
};

}  // namespace isoline
