// Fast transforms of real grids (rows, columns), column-major: the only adapter to FFTW. A
// transform owns its plans and scratch arrays, is unnormalized, and allocates nothing after
// construction. It always executes the same plan, so equal input gives equal bits at every address.
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

// X_k = 2 Σ x_i sin(π(i+1)(k+1)/(rows+1)) of each column of a grid, the DST-I, its own inverse but
// for a factor: by a real transform of the column's odd extension, of length 2(rows + 1). FFTW's
// own, RODFT00, takes two to five times as long.
class SineTransform {
 public:
  explicit SineTransform(Index rows);

  void columns(BatchRef grid, BatchOut spectrum);  // (rows, any), which may be the same array
  Real round_trip() const { return static_cast<Real>(odd_.size()); }

 private:
  Vector odd_;             // (2 rows + 2)
  Eigen::VectorXcd half_;  // (rows + 2) of its spectrum, which is −iX
  FourierPlan plan_;
};

}  // namespace isoline
