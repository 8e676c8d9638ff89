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
      back_(sized(N)),
      ahead_(sized(N)),
      q_(stride_ * stride_),
      places_(Vector::LinSpaced(N, 0, static_cast<Real>(N - 1))) {
  s_ = tangent_ = moved_ = Vector::Zero(stride_ * stride_);
}

// By periods into [0, N]. Of a displacement that is no number the node lies in the grid, and the
// distance from it is none either.
void Advection::trace(VectorRef dx, VectorRef dy, Real sign, Trace& out) const {
  const Real N = static_cast<Real>(N_), inverse = 1 / N;
  const int stride = static_cast<int>(stride_);
  for (Index j = 0; j < N_; ++j) {
    VectorOut x = out.a.segment(N_ * j, N_), y = out.b.segment(N_ * j, N_);
    x = places_ + sign * dx.segment(N_ * j, N_);
    y = Vector::Constant(N_, places_[j]) + sign * dy.segment(N_ * j, N_);
    x.array() -= N * (x.array() * inverse).floor();
    y.array() -= N * (y.array() * inverse).floor();
    Real* __restrict a = x.data(), * __restrict b = y.data();
    int* __restrict node = out.node.data() + N_ * j;
    for (Index i = 0; i < N_; ++i) {
      const Real from_x = a[i] > 0 ? a[i] : 0, from_y = b[i] > 0 ? b[i] : 0;
      const int nx = static_cast<int>(from_x < N ? from_x : N);
      const int ny = static_cast<int>(from_y < N ? from_y : N);
      a[i] -= nx;
      b[i] -= ny;
      node[i] = nx + stride * ny;
    }
  }
}

void Advection::pad(VectorRef q, Vector& padded) const {
  for (Index j = 0; j < N_; ++j) padded.segment(stride_ * j, N_) = q.segment(N_ * j, N_);
  wrap(padded);
}

void Advection::wrap(Vector& padded) const {
  for (Index j = 0; j < N_; ++j)
    padded.segment<2>(stride_ * j + N_) = padded.segment<2>(stride_ * j);
  padded.tail(2 * stride_) = padded.head(2 * stride_);
}

void Advection::fold(Vector& padded) const {
  padded.head(2 * stride_) += padded.tail(2 * stride_);
  for (Index j = 0; j < N_; ++j)
    padded.segment<2>(stride_ * j) += padded.segment<2>(stride_ * j + N_);
}

void Advection::unpad(Vector& padded, VectorOut q) const {
  fold(padded);
  for (Index j = 0; j < N_; ++j) q.segment(N_ * j, N_) += padded.segment(stride_ * j, N_);
}

void Advection::prepare(VectorRef q, VectorRef dx, VectorRef dy) {
  trace(dx, dy, -1, back_);
  trace(dx, dy, 1, ahead_);
  pad(q, q_);
  for (Index j = 0; j < N_; ++j) {
    const int* node = back_.node.data() + N_ * j;
    const Real *a = back_.a.data() + N_ * j, *b = back_.b.data() + N_ * j, *from = q_.data();
    Real* to = s_.data() + stride_ * j;
    for (Index i = 0; i < N_; ++i) to[i] = Nodes(from + node[i], stride_).mean(a[i], b[i]);
  }
  wrap(s_);
}

void Advection::value(VectorOut out) const {
  for (Index j = 0; j < N_; ++j) {
    const int *back = back_.node.data() + N_ * j, *ahead = ahead_.node.data() + N_ * j;
    const Real *a = ahead_.a.data() + N_ * j, *b = ahead_.b.data() + N_ * j;
    const Real *q = q_.data(), *s = s_.data();
    const Real *own_q = q + stride_ * j, *own_s = s + stride_ * j;
    Real* to = out.data() + N_ * j;
    for (Index i = 0; i < N_; ++i) {
      const Real returned = Nodes(s + ahead[i], stride_).mean(a[i], b[i]);
      const Real r = own_s[i] + 0.5 * (own_q[i] - returned);
      const Nodes nodes(q + back[i], stride_);
      const Real least = nodes.least(), most = nodes.most();
      to[i] = r < least ? least : (r > most ? most : r);
    }
  }
}

void Advection::pushforward(VectorRef vq, VectorRef vdx, VectorRef vdy, VectorOut out) {
  pad(vq, tangent_);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Nodes nodes(q_.data() + back_.node[p], stride_);
      const Nodes moving(tangent_.data() + back_.node[p], stride_);
      moved_[stride_ * j + i] = moving.mean(back_.a[p], back_.b[p]) -
                                nodes.slope_x(back_.b[p]) * vdx[p] -
                                nodes.slope_y(back_.a[p]) * vdy[p];
    }
  wrap(moved_);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Real a = ahead_.a[p], b = ahead_.b[p];
      const Index own = stride_ * j + i, back = back_.node[p];
      const Nodes found(s_.data() + ahead_.node[p], stride_), nodes(q_.data() + back, stride_);
      const Real r = s_[own] + 0.5 * (q_[own] - found.mean(a, b));
      if (r < nodes.least() || r > nodes.most()) {
        const Real held = r < nodes.least() ? nodes.least() : nodes.most();
        out[p] = tangent_[back + nodes.place(held, stride_)];
        continue;
      }
      const Real returned = Nodes(moved_.data() + ahead_.node[p], stride_).mean(a, b) +
                            found.slope_x(b) * vdx[p] + found.slope_y(a) * vdy[p];
      out[p] = moved_[own] + 0.5 * (vq[p] - returned);
    }
}

void Advection::pullback(VectorRef u, VectorOut q, VectorOut dx, VectorOut dy) {
  Vector &of_q = tangent_, &of_s = moved_;
  of_q.setZero();
  of_s.setZero();
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Real a = ahead_.a[p], b = ahead_.b[p];
      const Index own = stride_ * j + i, back = back_.node[p], ahead = ahead_.node[p];
      const Nodes found(s_.data() + ahead, stride_), nodes(q_.data() + back, stride_);
      const Real r = s_[own] + 0.5 * (q_[own] - found.mean(a, b));
      if (r < nodes.least() || r > nodes.most()) {
        const Real held = r < nodes.least() ? nodes.least() : nodes.most();
        of_q[back + nodes.place(held, stride_)] += u[p];
        continue;
      }
      of_s[own] += u[p];
      of_q[own] += 0.5 * u[p];
      const Real returned = -0.5 * u[p];
      spread(returned, a, b, of_s.data() + ahead, stride_);
      dx[p] += returned * found.slope_x(b);
      dy[p] += returned * found.slope_y(a);
    }
  fold(of_s);
  for (Index j = 0, p = 0; j < N_; ++j)
    for (Index i = 0; i < N_; ++i, ++p) {
      const Nodes nodes(q_.data() + back_.node[p], stride_);
      const Real a = back_.a[p], b = back_.b[p], passed = of_s[stride_ * j + i];
      spread(passed, a, b, of_q.data() + back_.node[p], stride_);
      dx[p] -= passed * nodes.slope_x(b);
      dy[p] -= passed * nodes.slope_y(a);
    }
  unpad(of_q, q);
}

}  // namespace isoline::problems
