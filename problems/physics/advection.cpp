// MacCormack advection, its pushforward and its pullback; sums of neighbours, column by column.
#include "problems/physics/advection.h"

#include <cmath>

namespace isoline::problems {
namespace {

// The values, with 0 for those that were seen before.
Four fresh(const Four& values, Index seen) {
  return Four{0, 1, 2, 3} < static_cast<Real>(seen) ? Four{} : values;
}

}  // namespace

Advection::Advection(Index N)
    : N_(N),
      margin_(N),
      stride_(margin_.stride()),
      back_{Eigen::VectorXi(N * N), Vector(N * N), Vector(N * N)},
      ahead_(back_),
      least_(N * N),
      most_(N * N),
      q_(Vector::Zero(margin_.size())),
      s_(q_),
      tangent_(q_),
      moved_(q_),
      pairs_(Vector::Zero(2 * margin_.size())) {}

void Advection::trace(VectorRef dx, VectorRef dy) {
  const Index N = N_;
  const Real *x = dx.data(), *y = dy.data();
  trace([=](Index j) {
    return [from_x = x + N * j, from_y = y + N * j](Index i) {
      return Displacement{four_at(from_x + i), four_at(from_y + i)};
    };
  });
}

// If a displacement is NaN, or so large that rounding removes its fraction, the node is inside the
// lattice, and the distance from a NaN is NaN as well.
void Advection::keep_far(Index i, Index j, Real x, Real y, Points& out) const {
  const Real N = static_cast<Real>(N_);
  const auto within = [N](Real place) {
    const Real inside = place - N * std::floor(place / N);
    return inside > 0 && inside < N ? static_cast<Index>(inside) : 0;
  };
  const Real across = std::floor(x), along = std::floor(y);
  const Index p = i + N_ * j, node = margin_.own(within(static_cast<Real>(i) + across),
                                                 within(static_cast<Real>(j) + along));
  out.way[p] = static_cast<int>(node - margin_.own(i, j));
  out.a[p] = x - across;
  out.b[p] = y - along;
}

void Advection::interpolate(VectorRef q) {
  margin_.pad(q, q_);
  const Places back(back_);
  const Index stride = stride_;
  const Real* from = q_.data();
  Real *to = s_.data(), *least = least_.data(), *most = most_.data();
  margin_.by_fours([=](Index p, Index here, Index) {
    const Nodes<Four> nodes = nodes_at(from + here, back.way(p), stride);
    put(nodes.mean(back.a(p), back.b(p)), to + here);
    put(nodes.least(), least + p);
    put(nodes.most(), most + p);
  });
  margin_.wrap(s_);
}

void Advection::value(VectorRef q, VectorOut out) {
  interpolate(q);
  const Places ahead(ahead_);
  const Index stride = stride_;
  const Real *before = q_.data(), *there = s_.data();
  const Real *least = least_.data(), *most = most_.data();
  Real* to = out.data();
  margin_.by_fours([=](Index p, Index here, Index) {
    const Nodes<Four> found = nodes_at(there + here, ahead.way(p), stride);
    const Four back = found.mean(ahead.a(p), ahead.b(p));
    const Four r = four_at(there + here) + 0.5 * (four_at(before + here) - back);
    const Four low = four_at(least + p), high = four_at(most + p);
    const Four above = r < low ? low : r;
    put(above > high ? high : above, to + p);
  });
}

void Advection::add_choices(VectorRef q, PieceDigest& digest) {
  interpolate(q);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Index from = margin_.own(i, j) + back_.way[p], to = margin_.own(i, j) + ahead_.way[p];
      const Nodes<Real> found = nodes_at(s_.data() + to, stride_);
      const Real back = found.mean(ahead_.a[p], ahead_.b[p]);
      const Real r = s_[margin_.own(i, j)] + 0.5 * (q_[margin_.own(i, j)] - back);
      const bool is_below = r<least_[p], is_above = r> most_[p];
      const Nodes<Real> nodes = nodes_at(q_.data() + from, stride_);
      const Index held =
          is_below || is_above ? 1 + nodes.place(is_below ? least_[p] : most_[p], stride_) : 0;
      for (const Index choice : {from, to, held}) digest.add(static_cast<std::uint64_t>(choice));
    }
}

void Advection::pushforward(VectorRef q, VectorRef vq, VectorRef vdx, VectorRef vdy,
                            VectorOut out) {
  interpolate(q);
  margin_.pad(vq, tangent_);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Index node = margin_.own(i, j) + back_.way[p];
      const Real a = back_.a[p], b = back_.b[p];
      const Nodes<Real> nodes = nodes_at(q_.data() + node, stride_);
      const Nodes<Real> moving = nodes_at(tangent_.data() + node, stride_);
      moved_[margin_.own(i, j)] =
          moving.mean(a, b) - nodes.slope_x(b) * vdx[p] - nodes.slope_y(a) * vdy[p];
    }
  margin_.wrap(moved_);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Index node = margin_.own(i, j) + ahead_.way[p];
      const Real a = ahead_.a[p], b = ahead_.b[p];
      const Nodes<Real> found = nodes_at(s_.data() + node, stride_);
      const Real r = s_[margin_.own(i, j)] + 0.5 * (q_[margin_.own(i, j)] - found.mean(a, b));
      if (r < least_[p] || r > most_[p]) {
        const Index back = margin_.own(i, j) + back_.way[p];
        const Nodes<Real> nodes = nodes_at(q_.data() + back, stride_);
        out[p] = tangent_[back + nodes.place(r < least_[p] ? least_[p] : most_[p], stride_)];
        continue;
      }
      const Real returned = nodes_at(moved_.data() + node, stride_).mean(a, b) +
                            found.slope_x(b) * vdx[p] + found.slope_y(a) * vdy[p];
      out[p] = moved_[margin_.own(i, j)] + 0.5 * (vq[p] - returned);
    }
}

void Advection::pullback(VectorRef q, VectorRef u, VectorOut of_q, VectorOut of_dx,
                         VectorOut of_dy) {
  interpolate(q);
  Vector &into_q = tangent_, &into_s = moved_;
  into_q.setZero();
  into_s.setZero();
  pull_correction(u, into_q, into_s, of_dx, of_dy);
  margin_.settle(pairs_, into_s);
  margin_.fold(into_s);
  pull_interpolation(into_s, of_dx, of_dy);
  margin_.settle(pairs_, into_q);
  margin_.unpad(into_q, of_q);
}

// The derivative of q' as a function of q, s and p + d.
void Advection::pull_correction(VectorRef u, Vector& into_q, Vector& into_s, VectorOut of_dx,
                                VectorOut of_dy) {
  const Places back(back_), ahead(ahead_);
  const Index stride = stride_;
  const Real *before = q_.data(), *there = s_.data(), *from = u.data();
  const Real *least = least_.data(), *most = most_.data();
  Real *to_q = into_q.data(), *to_s = into_s.data(), *pairs = pairs_.data();
  Real *to_dx = of_dx.data(), *to_dy = of_dy.data();
  margin_.by_fours([=](Index p, Index here, Index seen) {
    const Four a = ahead.a(p), b = ahead.b(p), all = fresh(four_at(from + p), seen);
    const Nodes<Four> found = nodes_at(there + here, ahead.way(p), stride);
    const Four r = four_at(there + here) + 0.5 * (four_at(before + here) - found.mean(a, b));
    const Four low = four_at(least + p), high = four_at(most + p);
    const auto is_below = r < low, is_held = is_below | (r > high);
    if (is_held[0] | is_held[1] | is_held[2] | is_held[3])
      for (Index k = 0; k < 4; ++k) {
        if (is_held[k] == 0) continue;
        const Index node = here + k + back.way(p)[k];
        const Nodes<Real> nodes = nodes_at(before + node, stride);
        to_q[node + nodes.place(is_below[k] ? low[k] : high[k], stride)] += all[k];
      }
    const Four free = is_held ? Four{} : all, returned = -0.5 * free;
    add(free, to_s + here);
    add(0.5 * free, to_q + here);
    spread(returned, a, b, ahead.way(p), stride, pairs + 2 * here);
    add(returned * found.slope_x(b), to_dx + p);
    add(returned * found.slope_y(a), to_dy + p);
  });
}

// The derivative of s as a function of q and p − d.
void Advection::pull_interpolation(const Vector& into_s, VectorOut of_dx, VectorOut of_dy) {
  const Places back(back_);
  const Index stride = stride_;
  const Real *before = q_.data(), *from = into_s.data();
  Real *pairs = pairs_.data(), *to_dx = of_dx.data(), *to_dy = of_dy.data();
  margin_.by_fours([=](Index p, Index here, Index seen) {
    const Four a = back.a(p), b = back.b(p), passed = fresh(four_at(from + here), seen);
    const Nodes<Four> nodes = nodes_at(before + here, back.way(p), stride);
    spread(passed, a, b, back.way(p), stride, pairs + 2 * here);
    add(-passed * nodes.slope_x(b), to_dx + p);
    add(-passed * nodes.slope_y(a), to_dy + p);
  });
}

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
