// The five-point Laplacian ∇² on N×N cells of width 1, with a value 0 one width beyond the first
// and last cell, and its inverse: by the sine transform along columns, which leaves of each of its
// waves p a tridiagonal system along rows (Hockney, 1965),
//
//   −y_{j−1} + (2 + s_p) y_j − y_{j+1} = −x_j,  s_p = 4 sin²(πp/2(N+1)),
//
// diagonally dominant, so eliminated without pivots. Grids are columns, (N², B).
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
  mutable SineTransform sine_;  // it has scratch
  Matrix pivots_;               // of the elimination, inverted: of wave p in column j, (N, N)
};

}  // namespace isoline::problems
