// MacCormack advection, its pushforward and its pullback.
#include "problems/physics/advection.h"

#include <cmath>

#include "problems/physics/lattice_nodes.h"

namespace isoline::problems {
namespace {

// Adds the transpose of Nodes::mean.
void spread(Real u, Real a, Real b, Real* q, Index stride) {
  q[0] += (1 - a) * (1 - b) * u;
  q[1] += a * (1 - b) * u;
  q[stride] += (1 - a) * b * u;
  q[stride + 1] += a * b * u;
}

}  // namespace

Advection::Advection(Index N)
    : N_(N),
      stride_(N + 2 * kMargin),
      back_{Eigen::VectorXi(N * N), Vector(N * N), Vector(N * N)},
      ahead_(back_),
      least_(N * N),
      most_(N * N),
      q_(Vector::Zero(stride_ * stride_)),
      s_(q_),
      tangent_(q_),
      moved_(q_) {}

bool Advection::trace(VectorRef dx, VectorRef dy) {
  const Real stride = static_cast<Real>(stride_), reach = static_cast<Real>(kReach);
  auto are_near = Four{} == 0;  // a mask
  const Real *x = dx.data(), *y = dy.data();
  int *back = back_.node.data(), *ahead = ahead_.node.data();
  Real *back_a = back_.a.data(), *back_b = back_.b.data();
  Real *ahead_a = ahead_.a.data(), *ahead_b = ahead_.b.data();
  by_fours(N_, [&](Index i, Index j) {
    const Index p = N_ * j + i;
    const Four across = four_at(x + p), along = four_at(y + p);
    are_near &= (across <= reach) & (across >= -reach) & (along <= reach) & (along >= -reach);
    const Four here = static_cast<Real>(own(i, j)) + Four{0, 1, 2, 3};
    const Four right = floor_of(across), up = floor_of(along);
    const Four left = floor_of(-across), down = floor_of(-along);
    put_nodes(here + right + stride * up, ahead + p);
    put(across - right, ahead_a + p);
    put(along - up, ahead_b + p);
    put_nodes(here + left + stride * down, back + p);
    put(-across - left, back_a + p);
    put(-along - down, back_b + p);
  });
  return are_near[0] && are_near[1] && are_near[2] && are_near[3];
}

// Where a displacement is no number, or has lost its whole part to rounding, the node lies in the
// lattice, and of the first the distance is no number either.
void Advection::trace_far(VectorRef dx, VectorRef dy, Real sign, Points& out) const {
  const Real N = static_cast<Real>(N_);
  const auto within = [N](Real place) {
    const Real inside = place - N * std::floor(place / N);
    return inside > 0 && inside < N ? static_cast<Index>(inside) : 0;
  };
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Real x = sign * dx[p], y = sign * dy[p], across = std::floor(x), along = std::floor(y);
      out.node[p] = static_cast<int>(
          own(within(static_cast<Real>(i) + across), within(static_cast<Real>(j) + along)));
      out.a[p] = x - across;
      out.b[p] = y - along;
    }
}

void Advection::pad(VectorRef q, Vector& padded) const {
  for (Index j = 0; j < N_; ++j) padded.segment(own(0, j), N_) = q.segment(N_ * j, N_);
  wrap(padded);
}

// One by one, for a margin may be wider than the lattice.
void Advection::wrap(Vector& padded) const {
  for (Index j = 0; j < N_; ++j) {
    Real* row = padded.data() + own(-kMargin, j);
    for (Index k = 0; k < kMargin; ++k) row[N_ + kMargin + k] = row[kMargin + k];
    for (Index k = kMargin; k-- > 0;) row[k] = row[N_ + k];
  }
  const Index period = stride_ * N_;
  for (Index j = N_ + kMargin; j < stride_; ++j)
    padded.segment(stride_ * j, stride_) = padded.segment(stride_ * j - period, stride_);
  for (Index j = kMargin; j-- > 0;)
    padded.segment(stride_ * j, stride_) = padded.segment(stride_ * j + period, stride_);
}

void Advection::fold(Vector& padded) const {
  const Index period = stride_ * N_;
  for (Index j = 0; j < kMargin; ++j)
    padded.segment(stride_ * j + period, stride_) += padded.segment(stride_ * j, stride_);
  for (Index j = stride_; j-- > N_ + kMargin;)
    padded.segment(stride_ * j - period, stride_) += padded.segment(stride_ * j, stride_);
  for (Index j = 0; j < N_; ++j) {
    Real* row = padded.data() + own(-kMargin, j);
    for (Index k = 0; k < kMargin; ++k) row[N_ + k] += row[k];
    for (Index k = kMargin; k-- > 0;) row[kMargin + k] += row[N_ + kMargin + k];
  }
}

void Advection::unpad(Vector& padded, VectorOut q) const {
  fold(padded);
  for (Index j = 0; j < N_; ++j) q.segment(N_ * j, N_) += padded.segment(own(0, j), N_);
}

void Advection::interpolate(VectorRef q, VectorRef dx, VectorRef dy) {
  pad(q, q_);
  if (!trace(dx, dy)) {
    trace_far(dx, dy, -1, back_);
    trace_far(dx, dy, 1, ahead_);
  }
  const Real *from = q_.data(), *a = back_.a.data(), *b = back_.b.data();
  const int* node = back_.node.data();
  Real *to = s_.data(), *least = least_.data(), *most = most_.data();
  by_fours(N_, [&](Index i, Index j) {
    const Index p = N_ * j + i;
    const Nodes<Four> nodes = nodes_at(from, node + p, stride_);
    put(nodes.mean(four_at(a + p), four_at(b + p)), to + own(i, j));
    put(nodes.least(), least + p);
    put(nodes.most(), most + p);
  });
  wrap(s_);
}

void Advection::value(VectorRef q, VectorRef dx, VectorRef dy, VectorOut out) {
  interpolate(q, dx, dy);
  const Real *before = q_.data(), *there = s_.data(), *a = ahead_.a.data(), *b = ahead_.b.data();
  const Real *least = least_.data(), *most = most_.data();
  const int* node = ahead_.node.data();
  by_fours(N_, [&](Index i, Index j) {
    const Index p = N_ * j + i, here = own(i, j);
    const Four back = nodes_at(there, node + p, stride_).mean(four_at(a + p), four_at(b + p));
    const Four r = four_at(there + here) + 0.5 * (four_at(before + here) - back);
    const Four low = four_at(least + p), high = four_at(most + p);
    const Four above = r < low ? low : r;
    put(above > high ? high : above, out.data() + p);
  });
}

void Advection::add_choices(VectorRef q, VectorRef dx, VectorRef dy, PieceDigest& digest) {
  interpolate(q, dx, dy);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Nodes<Real> found = nodes_at(s_.data() + ahead_.node[p], stride_);
      const Real back = found.mean(ahead_.a[p], ahead_.b[p]);
      const Real r = s_[own(i, j)] + 0.5 * (q_[own(i, j)] - back);
      const bool is_below = r<least_[p], is_above = r> most_[p];
      const Nodes<Real> nodes = nodes_at(q_.data() + back_.node[p], stride_);
      const Index held =
          is_below || is_above ? 1 + nodes.place(is_below ? least_[p] : most_[p], stride_) : 0;
      for (const Index choice : {Index(back_.node[p]), Index(ahead_.node[p]), held})
        digest.add(static_cast<std::uint64_t>(choice));
    }
}

void Advection::pushforward(VectorRef q, VectorRef dx, VectorRef dy, VectorRef vq, VectorRef vdx,
                            VectorRef vdy, VectorOut out) {
  interpolate(q, dx, dy);
  pad(vq, tangent_);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Index node = back_.node[p];
      const Real a = back_.a[p], b = back_.b[p];
      const Nodes<Real> nodes = nodes_at(q_.data() + node, stride_);
      const Nodes<Real> moving = nodes_at(tangent_.data() + node, stride_);
      moved_[own(i, j)] = moving.mean(a, b) - nodes.slope_x(b) * vdx[p] - nodes.slope_y(a) * vdy[p];
    }
  wrap(moved_);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Index node = ahead_.node[p];
      const Real a = ahead_.a[p], b = ahead_.b[p];
      const Nodes<Real> found = nodes_at(s_.data() + node, stride_);
      const Real r = s_[own(i, j)] + 0.5 * (q_[own(i, j)] - found.mean(a, b));
      if (r < least_[p] || r > most_[p]) {
        const Index back = back_.node[p];
        const Nodes<Real> nodes = nodes_at(q_.data() + back, stride_);
        out[p] = tangent_[back + nodes.place(r < least_[p] ? least_[p] : most_[p], stride_)];
        continue;
      }
      const Real returned = nodes_at(moved_.data() + node, stride_).mean(a, b) +
                            found.slope_x(b) * vdx[p] + found.slope_y(a) * vdy[p];
      out[p] = moved_[own(i, j)] + 0.5 * (vq[p] - returned);
    }
}

void Advection::pullback(VectorRef q, VectorRef dx, VectorRef dy, VectorRef u, VectorOut of_q,
                         VectorOut of_dx, VectorOut of_dy) {
  interpolate(q, dx, dy);
  Vector &into_q = tangent_, &into_s = moved_;
  into_q.setZero();
  into_s.setZero();
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Index node = ahead_.node[p];
      const Real a = ahead_.a[p], b = ahead_.b[p];
      const Nodes<Real> found = nodes_at(s_.data() + node, stride_);
      const Real r = s_[own(i, j)] + 0.5 * (q_[own(i, j)] - found.mean(a, b));
      if (r < least_[p] || r > most_[p]) {
        const Index back = back_.node[p];
        const Nodes<Real> nodes = nodes_at(q_.data() + back, stride_);
        into_q[back + nodes.place(r < least_[p] ? least_[p] : most_[p], stride_)] += u[p];
        continue;
      }
      into_s[own(i, j)] += u[p];
      into_q[own(i, j)] += 0.5 * u[p];
      const Real returned = -0.5 * u[p];
      spread(returned, a, b, into_s.data() + node, stride_);
      of_dx[p] += returned * found.slope_x(b);
      of_dy[p] += returned * found.slope_y(a);
    }
  fold(into_s);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Index node = back_.node[p];
      const Real a = back_.a[p], b = back_.b[p];
      const Nodes<Real> nodes = nodes_at(q_.data() + node, stride_);
      const Real passed = into_s[own(i, j)];
      spread(passed, a, b, into_q.data() + node, stride_);
      of_dx[p] -= passed * nodes.slope_x(b);
      of_dy[p] -= passed * nodes.slope_y(a);
    }
  unpad(into_q, of_q);
}

}  // namespace isoline::problems
