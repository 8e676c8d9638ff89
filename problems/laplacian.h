// The five-point Laplacian ∇² on N×N cells of width 1, with a value 0 one width beyond the first
// and last cell, and its inverse. The sine transform diagonalizes it,
// λ_pq = −4 [sin²(πp/2(N+1)) + sin²(πq/2(N+1))]. Grids are columns, (N², B).
#pragma once

#include "core/array.h"
#include "core/fourier.h"

namespace isoline::problems {

class Laplacian {
 public:
  explicit Laplacian(Index N);
  Index cells() const { return N_ * N_; }
  void apply(BatchRef y, BatchOut x) const;  // x = ∇²y
  void solve(BatchRef x, BatchOut y) const;  // ∇²y = x

 private:
  Index N_;
  mutable SineTransform2d sine_;  // its spectrum is scratch
  Matrix gain_;                   // 1/λ over the factor of a round trip, (N, N)
};

}  // namespace isoline::problems
