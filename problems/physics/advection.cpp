// MacCormack advection, its pushforward and its pullback.
#include "problems/physics/advection.h"

#include <cmath>

namespace isoline::problems {
namespace {

// The four nodes around a point, at distances a and b from the first.
struct Nodes {
  Real q00, q10, q01, q11;

  Nodes(const Real* q, Index stride) : q00(q[0]), q10(q[1]), q01(q[stride]), q11(q[stride + 1]) {}

  Real mean(Real a, Real b) const {
    return (1 - b) * (q00 + a * (q10 - q00)) + b * (q01 + a * (q11 - q01));
  }
  Real slope_x(Real b) const { return (1 - b) * (q10 - q00) + b * (q11 - q01); }
  Real slope_y(Real a) const { return (1 - a) * (q01 - q00) + a * (q11 - q10); }
  Real least() const { return lesser(lesser(q00, q10), lesser(q01, q11)); }
  Real most() const { return greater(greater(q00, q10), greater(q01, q11)); }

  // Where the node of that value lies from the first.
  Index place(Real value, Index stride) const {
    if (q00 == value) return 0;
    if (q10 == value) return 1;
    return q01 == value ? stride : stride + 1;
  }

 private:
  static Real lesser(Real a, Real b) { return b < a ? b : a; }
  static Real greater(Real a, Real b) { return b > a ? b : a; }
};

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
      stride_(N + 2),
      back_{Eigen::VectorXi(N), Vector(N), Vector(N)},
      ahead_(back_),
      cell_(N * N),
      q_(Vector::Zero(stride_ * stride_)),
      s_(q_),
      tangent_(q_),
      moved_(q_) {}

// By periods into [0, N]: adding kRounder and taking it away rounds to a whole number, in a loop
// that vectorizes. Of a displacement that is no number the node lies in the grid, and the distance
// from it is none either.
void Advection::trace(Index j, VectorRef dx, VectorRef dy, Real sign, Row& out) const {
  constexpr Real kRounder = 6755399441055744;  // 1.5 · 2⁵²
  const Real N = static_cast<Real>(N_), inverse = 1 / N, row = static_cast<Real>(j);
  const int stride = static_cast<int>(stride_), cells = static_cast<int>(N_);
  const Real* __restrict x = dx.data() + N_ * j, * __restrict y = dy.data() + N_ * j;
  Real* __restrict a = out.a.data(), * __restrict b = out.b.data();
  int* __restrict node = out.node.data();
  for (int i = 0; i < cells; ++i) {
    const Real to_x = static_cast<Real>(i) + sign * x[i], to_y = row + sign * y[i];
    const Real in_x = to_x - N * ((to_x * inverse - 0.5 + kRounder) - kRounder);
    const Real in_y = to_y - N * ((to_y * inverse - 0.5 + kRounder) - kRounder);
    const Real from_x = in_x > 0 ? in_x : 0, from_y = in_y > 0 ? in_y : 0;
    const int nx = static_cast<int>(from_x < N ? from_x : N);
    const int ny = static_cast<int>(from_y < N ? from_y : N);
    a[i] = in_x - nx;
    b[i] = in_y - ny;
    node[i] = nx + stride * ny;
  }
}

void Advection::pad(VectorRef q, VectorOut padded) const {
  for (Index j = 0; j < N_; ++j) padded.segment(stride_ * j, N_) = q.segment(N_ * j, N_);
  wrap(padded);
}

void Advection::wrap(VectorOut padded) const {
  for (Index j = 0; j < N_; ++j)
    padded.segment<2>(stride_ * j + N_) = padded.segment<2>(stride_ * j);
  padded.tail(2 * stride_) = padded.head(2 * stride_);
}

void Advection::fold(VectorOut padded) const {
  padded.head(2 * stride_) += padded.tail(2 * stride_);
  for (Index j = 0; j < N_; ++j)
    padded.segment<2>(stride_ * j) += padded.segment<2>(stride_ * j + N_);
}

void Advection::unpad(VectorOut padded, VectorOut q) const {
  fold(padded);
  for (Index j = 0; j < N_; ++j) q.segment(N_ * j, N_) += padded.segment(stride_ * j, N_);
}

void Advection::interpolate(VectorRef q, VectorRef dx, VectorRef dy) {
  pad(q, q_);
  for (Index j = 0; j < N_; ++j) {
    trace(j, dx, dy, -1, back_);
    cell_.segment(N_ * j, N_) = back_.node;
    const Real* from = q_.data();
    Real* to = s_.data() + stride_ * j;
    for (Index i = 0; i < N_; ++i)
      to[i] = Nodes(from + back_.node[i], stride_).mean(back_.a[i], back_.b[i]);
  }
  wrap(s_);
}

void Advection::value(VectorRef q, VectorRef dx, VectorRef dy, VectorOut out) {
  interpolate(q, dx, dy);
  for (Index j = 0; j < N_; ++j) {
    trace(j, dx, dy, 1, ahead_);
    const Real *own_q = q_.data() + stride_ * j, *own_s = s_.data() + stride_ * j;
    const int* cell = cell_.data() + N_ * j;
    Real* to = out.data() + N_ * j;
    for (Index i = 0; i < N_; ++i) {
      const Nodes found(s_.data() + ahead_.node[i], stride_);
      const Real r = own_s[i] + 0.5 * (own_q[i] - found.mean(ahead_.a[i], ahead_.b[i]));
      const Nodes nodes(q_.data() + cell[i], stride_);
      const Real least = nodes.least(), most = nodes.most();
      to[i] = r < least ? least : (r > most ? most : r);
    }
  }
}

void Advection::pushforward(VectorRef q, VectorRef dx, VectorRef dy, VectorRef vq, VectorRef vdx,
                            VectorRef vdy, VectorOut out) {
  interpolate(q, dx, dy);
  pad(vq, tangent_);
  for (Index j = 0, p = 0; j < N_; ++j) {
    trace(j, dx, dy, -1, back_);
    for (Index i = 0; i < N_; ++i, ++p) {
      const Nodes nodes(q_.data() + back_.node[i], stride_);
      const Nodes moving(tangent_.data() + back_.node[i], stride_);
      moved_[stride_ * j + i] = moving.mean(back_.a[i], back_.b[i]) -
                                nodes.slope_x(back_.b[i]) * vdx[p] -
                                nodes.slope_y(back_.a[i]) * vdy[p];
    }
  }
  wrap(moved_);
  for (Index j = 0, p = 0; j < N_; ++j) {
    trace(j, dx, dy, 1, ahead_);
    for (Index i = 0; i < N_; ++i, ++p) {
      const Real a = ahead_.a[i], b = ahead_.b[i];
      const Index own = stride_ * j + i, back = cell_[p];
      const Nodes found(s_.data() + ahead_.node[i], stride_), nodes(q_.data() + back, stride_);
      const Real r = s_[own] + 0.5 * (q_[own] - found.mean(a, b));
      if (r < nodes.least() || r > nodes.most()) {
        const Real held = r < nodes.least() ? nodes.least() : nodes.most();
        out[p] = tangent_[back + nodes.place(held, stride_)];
        continue;
      }
      const Real returned = Nodes(moved_.data() + ahead_.node[i], stride_).mean(a, b) +
                            found.slope_x(b) * vdx[p] + found.slope_y(a) * vdy[p];
      out[p] = moved_[own] + 0.5 * (vq[p] - returned);
    }
  }
}

void Advection::pullback(VectorRef q, VectorRef dx, VectorRef dy, VectorRef u, VectorOut of_q,
                         VectorOut of_dx, VectorOut of_dy) {
  interpolate(q, dx, dy);
  VectorOut into_q = tangent_, into_s = moved_;
  into_q.setZero();
  into_s.setZero();
  for (Index j = 0, p = 0; j < N_; ++j) {
    trace(j, dx, dy, 1, ahead_);
    for (Index i = 0; i < N_; ++i, ++p) {
      const Real a = ahead_.a[i], b = ahead_.b[i];
      const Index own = stride_ * j + i, back = cell_[p], ahead = ahead_.node[i];
      const Nodes found(s_.data() + ahead, stride_), nodes(q_.data() + back, stride_);
      const Real r = s_[own] + 0.5 * (q_[own] - found.mean(a, b));
      if (r < nodes.least() || r > nodes.most()) {
        const Real held = r < nodes.least() ? nodes.least() : nodes.most();
        into_q[back + nodes.place(held, stride_)] += u[p];
        continue;
      }
      into_s[own] += u[p];
      into_q[own] += 0.5 * u[p];
      const Real returned = -0.5 * u[p];
      spread(returned, a, b, into_s.data() + ahead, stride_);
      of_dx[p] += returned * found.slope_x(b);
      of_dy[p] += returned * found.slope_y(a);
    }
  }
  fold(into_s);
  for (Index j = 0, p = 0; j < N_; ++j) {
    trace(j, dx, dy, -1, back_);
    for (Index i = 0; i < N_; ++i, ++p) {
      const Nodes nodes(q_.data() + back_.node[i], stride_);
      const Real a = back_.a[i], b = back_.b[i], passed = into_s[stride_ * j + i];
      spread(passed, a, b, into_q.data() + back_.node[i], stride_);
      of_dx[p] -= passed * nodes.slope_x(b);
      of_dy[p] -= passed * nodes.slope_y(a);
    }
  }
  unpad(into_q, of_q);
}

}  // namespace isoline::problems
