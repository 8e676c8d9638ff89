// Sums of neighbours, column by column.
#include "problems/physics/lattice.h"

namespace isoline::problems {
namespace {

template <bool adds>
void put(Real value, Real& out) {
  if constexpr (adds)
    out += value;
  else
    out = value;
}

// The row j, or the one beside it.
const Real* row_on(Side side, Index N, Index j, const Real* q) {
  return q + N * (side == Side::above ? (j + 1 < N ? j + 1 : 0) : (j > 0 ? j - 1 : N - 1));
}

template <bool adds>
void sweep(Index N, Real a, Real b, Side side, const Real* __restrict q, Real* __restrict out) {
  for (Index j = 0; j < N; ++j) {
    const Real* own = q + N * j;
    Real* to = out + N * j;
    if (side == Side::right) {
      for (Index i = 0; i + 1 < N; ++i) put<adds>(a * own[i] + b * own[i + 1], to[i]);
      put<adds>(a * own[N - 1] + b * own[0], to[N - 1]);
    } else if (side == Side::left) {
      put<adds>(a * own[0] + b * own[N - 1], to[0]);
      for (Index i = 1; i < N; ++i) put<adds>(a * own[i] + b * own[i - 1], to[i]);
    } else {
      const Real* other = row_on(side, N, j, q);
      for (Index i = 0; i < N; ++i) put<adds>(a * own[i] + b * other[i], to[i]);
    }
  }
}

void sweep_squares(Index N, Real a, Side across, Side along, const Real* __restrict q,
                   Real* __restrict out) {
  const Index step = across == Side::right ? 1 : -1, last = step > 0 ? N - 1 : 0;
  for (Index j = 0; j < N; ++j) {
    const Real* own = q + N * j;
    const Real* other = row_on(along, N, j, q);
    Real* to = out + N * j;
    const auto sum = [=](Index i) { return own[i] + other[i]; };
    const Index first = step > 0 ? 0 : 1;
    for (Index i = first; i < first + N - 1; ++i) to[i] += a * (sum(i) + sum(i + step));
    to[last] += a * (sum(last) + sum(N - 1 - last));
  }
}

}  // namespace

void add_square(Index N, Real a, Side across, Side along, VectorRef q, VectorOut out) {
  sweep_squares(N, a, across, along, q.data(), out.data());
}
void weigh(Index N, Real a, Real b, Side side, VectorRef q, VectorOut out) {
  sweep<false>(N, a, b, side, q.data(), out.data());
}
void add_weighed(Index N, Real a, Real b, Side side, VectorRef q, VectorOut out) {
  sweep<true>(N, a, b, side, q.data(), out.data());
}

// Margins filled, and their cotangents brought home.

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
