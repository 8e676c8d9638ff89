// A periodic N×N lattice with a margin around it, for no neighbour that is near to need a modulus.
#pragma once

#include "core/array.h"

namespace isoline::problems {

class LatticeMargin {
 public:
  static constexpr Index kWidth = 8, kReach = kWidth - 1;  // of what lies between nodes, in cells

  explicit LatticeMargin(Index N) : N_(N), stride_(N + 2 * kWidth) {}
  Index stride() const { return stride_; }
  Index size() const { return stride_ * stride_; }
  Index own(Index i, Index j) const { return stride_ * (j + kWidth) + i + kWidth; }

  void pad(VectorRef q, Vector& padded) const;
  void wrap(Vector& padded) const;                // fills the margin
  void unpad(Vector& padded, VectorOut q) const;  // the transpose of pad, added to q
  void fold(Vector& padded) const;                // the transpose of wrap
  // Adds to each node what `pairs` (2 stride²) has for it: its n-th pair is of the n-th node and
  // the one to the right. Leaves them 0.
  void settle(Vector& pairs, Vector& padded) const;

  // visit(i, p): four points of a row from its i-th on, the p-th of all. Where four do not go into
  // a row its last four are visited at its end.
  template <class Visit>
  void by_fours_of_row(Index j, const Visit& visit) const {
    const Index N = N_, p = N * j;
    for (Index i = 0; i + 4 <= N; i += 4) visit(i, p + i);
    if (N % 4 != 0) visit(N - 4, p + N - 4);
  }
  // visit(p, here, seen): of all rows, the first of the four at `here` in the padded lattice. So
  // many of them have been seen before.
  template <class Visit>
  void by_fours(const Visit& visit) const {
    const Index N = N_;
    for (Index j = 0; j < N; ++j) {
      const Index p = N * j, here = own(0, j);
      for (Index i = 0; i + 4 <= N; i += 4) visit(p + i, here + i, Index{0});
      if (N % 4 != 0) visit(p + N - 4, here + N - 4, 4 - N % 4);
    }
  }

 private:
  Index N_, stride_;
};

}  // namespace isoline::problems
