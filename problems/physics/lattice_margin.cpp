// Margins filled, and their cotangents brought home.
#include "problems/physics/lattice_margin.h"

namespace isoline::problems {

void LatticeMargin::pad(VectorRef q, Vector& padded) const {
  for (Index j = 0; j < N_; ++j) padded.segment(own(0, j), N_) = q.segment(N_ * j, N_);
  wrap(padded);
}

// One by one where the margin is wider than the lattice.
void LatticeMargin::wrap(Vector& padded) const {
  for (Index j = 0; j < N_; ++j) {
    const Index first = own(0, j);
    if (N_ >= kWidth) {
      padded.segment<kWidth>(first + N_) = padded.segment<kWidth>(first);
      padded.segment<kWidth>(first - kWidth) = padded.segment<kWidth>(first + N_ - kWidth);
      continue;
    }
    Real* row = padded.data() + first;
    for (Index k = 0; k < kWidth; ++k) row[N_ + k] = row[k];
    for (Index k = 1; k <= kWidth; ++k) row[-k] = row[N_ - k];
  }
  const Index period = stride_ * N_;
  for (Index j = N_ + kWidth; j < stride_; ++j)
    padded.segment(stride_ * j, stride_) = padded.segment(stride_ * j - period, stride_);
  for (Index j = kWidth; j-- > 0;)
    padded.segment(stride_ * j, stride_) = padded.segment(stride_ * j + period, stride_);
}

void LatticeMargin::fold(Vector& padded) const {
  const Index period = stride_ * N_;
  for (Index j = 0; j < kWidth; ++j)
    padded.segment(stride_ * j + period, stride_) += padded.segment(stride_ * j, stride_);
  for (Index j = stride_; j-- > N_ + kWidth;)
    padded.segment(stride_ * j - period, stride_) += padded.segment(stride_ * j, stride_);
  for (Index j = 0; j < N_; ++j) {
    Real* row = padded.data() + own(-kWidth, j);
    for (Index k = 0; k < kWidth; ++k) row[N_ + k] += row[k];
    for (Index k = kWidth; k-- > 0;) row[kWidth + k] += row[N_ + kWidth + k];
  }
}

void LatticeMargin::settle(Vector& pairs, Vector& padded) const {
  const Real* shares = pairs.data();
  Real* to = padded.data();
  to[0] += shares[0];
  for (Index n = 1; n < size(); ++n) to[n] += shares[2 * n] + shares[2 * n - 1];
  pairs.setZero();
}

void LatticeMargin::unpad(Vector& padded, VectorOut q) const {
  fold(padded);
  for (Index j = 0; j < N_; ++j) q.segment(N_ * j, N_) += padded.segment(own(0, j), N_);
}

}  // namespace isoline::problems
