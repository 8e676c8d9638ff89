// The lattice of the flow: where its nodes are, which are neighbours, and its margin; and
// MacCormack advection on it.
#pragma once

#include "core/array.h"
#include "core/workspace.h"

namespace isoline::problems {

// An unaligned vector may lie anywhere in an array of double.
using Four = double __attribute__((vector_size(32)));
using Pair = double __attribute__((vector_size(16)));
using LooseFour = double __attribute__((vector_size(32), aligned(8), may_alias));
using LoosePair = double __attribute__((vector_size(16), aligned(8), may_alias));

inline Four four_at(const Real* from) { return *reinterpret_cast<const LooseFour*>(from); }
inline void put(const Four& values, Real* to) { *reinterpret_cast<LooseFour*>(to) = values; }
inline void add(const Four& values, Real* to) { *reinterpret_cast<LooseFour*>(to) += values; }

// How far four points move.
struct Displacement {
  Four x, y;
};

// Beside four points of a periodic row, from its i-th on.
inline Four left_of(const Real* row, Index i, Index N) {
  return i > 0 ? four_at(row + i - 1) : Four{row[N - 1], row[0], row[1], row[2]};
}
inline Four right_of(const Real* row, Index i, Index N) {
  return i + 4 < N ? four_at(row + i + 1) : Four{row[N - 3], row[N - 2], row[N - 1], row[0]};
}

// The four nodes around a point, or around four points, at distances a and b from the first.
template <class T>
struct Nodes {
  T q00, q10, q01, q11;

  T mean(T a, T b) const {
    const T lower = q00 + a * (q10 - q00), upper = q01 + a * (q11 - q01);
    return lower + b * (upper - lower);
  }
  T slope_x(T b) const { return (1 - b) * (q10 - q00) + b * (q11 - q01); }
  T slope_y(T a) const { return (1 - a) * (q01 - q00) + a * (q11 - q10); }
  T least() const { return lesser(lesser(q00, q10), lesser(q01, q11)); }
  T most() const { return greater(greater(q00, q10), greater(q01, q11)); }

  // Where the node of that value lies from the first.
  Index place(Real value, Index stride) const {
    if (q00 == value) return 0;
    if (q10 == value) return 1;
    return q01 == value ? stride : stride + 1;
  }

 private:
  static T lesser(T a, T b) { return b < a ? b : a; }
  static T greater(T a, T b) { return b > a ? b : a; }
};

inline Nodes<Real> nodes_at(const Real* q, Index stride) {
  return {q[0], q[1], q[stride], q[stride + 1]};
}

// Two pairs as one vector. Of halves that are integers GCC makes one load and one insertion, of
// pairs of doubles two loads and an insertion.
inline Four pairs_at(const Real* left, const Real* right) {
  __extension__ using Half = __int128;
  using LooseHalf __attribute__((aligned(8), may_alias)) = Half;
  using Halves = Half __attribute__((vector_size(32)));
  return reinterpret_cast<Four>(Halves{*reinterpret_cast<const LooseHalf*>(left),
                                       *reinterpret_cast<const LooseHalf*>(right)});
}

// Around four points that lie side by side from q on, each with its own way to the first of its
// nodes. Two of a row lie side by side: eight pairs, and their transpose.
inline Nodes<Four> nodes_at(const Real* q, const int* way, Index stride) {
  const auto turned = [&](const Real* row, Four& left, Four& right) {
    const Four even = pairs_at(row + way[0], row + way[2] + 2);
    const Four odd = pairs_at(row + way[1] + 1, row + way[3] + 3);
    left = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
    right = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
  };
  Nodes<Four> nodes;
  turned(q, nodes.q00, nodes.q10);
  turned(q + stride, nodes.q01, nodes.q11);
  return nodes;
}

// Adds to the pairs of four nodes: the n-th is of the n-th node and the one to its right. These two
// are inline, for a call would spill all registers.
[[gnu::always_inline]] inline void add_pairs(const Four& left, const Four& right, const int* way,
                                             Real* pairs) {
  const Four even = __builtin_shufflevector(left, right, 0, 4, 2, 6);
  const Four odd = __builtin_shufflevector(left, right, 1, 5, 3, 7);
  const auto add_pair = [pairs](Index n, const Pair& shares) {
    *reinterpret_cast<LoosePair*>(pairs + 2 * n) += shares;
  };
  add_pair(way[0], __builtin_shufflevector(even, even, 0, 1));
  add_pair(way[1] + 1, __builtin_shufflevector(odd, odd, 0, 1));
  add_pair(way[2] + 2, __builtin_shufflevector(even, even, 2, 3));
  add_pair(way[3] + 3, __builtin_shufflevector(odd, odd, 2, 3));
}

// Adds the transpose of Nodes::mean for four points. It adds pairs rather than nodes: adding nodes
// two at a time would make a load wait for two stores that are one node apart.
[[gnu::always_inline]] inline void spread(const Four& u, const Four& a, const Four& b,
                                          const int* way, Index stride, Real* pairs) {
  const Four lower = (1 - b) * u, upper = b * u;
  add_pairs((1 - a) * lower, a * lower, way, pairs);
  add_pairs((1 - a) * upper, a * upper, way, pairs + 2 * stride);
}

// Applies to each of the four, by Eigen's own instruction if there is one.
template <class Function>
inline Four of_each(const Four& x, const Function& function) {
  const Eigen::Map<const Eigen::Array4d> each(reinterpret_cast<const Real*>(&x));
  const Eigen::Array4d values = function(each);
  return four_at(values.data());
}
inline Four floor_of(const Four& x) {
  return of_each(x, [](const auto& each) { return each.floor(); });
}
inline Four ceiling_of(const Four& x) {
  return of_each(x, [](const auto& each) { return each.ceil(); });
}
inline Four size_of(const Four& x) {
  return of_each(x, [](const auto& each) { return each.abs(); });
}

inline void put_ways(const Four& ways, int* to) {
  using LooseWays = int __attribute__((vector_size(16), aligned(4), may_alias));
  *reinterpret_cast<LooseWays*>(to) = __builtin_convertvector(ways, LooseWays);
}

// Sums of two neighbours on a periodic N×N grid, (N²) with x running fastest: of them are made the
// means between faces and centres, the differences of projection and viscosity, and their adjoints,
// for the transpose of a sum with one neighbour is the sum with the opposite one.

enum class Side { left, right, below, above };

// out = a q + b (q of the neighbour on that side), or out += that. `out` is never q.
void weigh(Index N, Real a, Real b, Side side, VectorRef q, VectorOut out);
void add_weighed(Index N, Real a, Real b, Side side, VectorRef q, VectorOut out);

// out += a times the sum of the four in the square that lies towards a side across, left or right,
// and one along, below or above.
void add_square(Index N, Real a, Side across, Side along, VectorRef q, VectorOut out);

// A periodic N×N lattice with a margin around it, for no neighbour that is near to need a modulus.

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

// MacCormack advection of a quantity q on a periodic N×N lattice by displacements d, in cells a
// step, given at the lattice's own points; Selle, Fedkiw, Kim, Liu, Rossignac (2008), and PhiFlow:
//
//   s(p) = q(p − d(p)),  r(p) = s(p) + ½ (q(p) − s(p + d(p))),  q' = clamp(r, min, max),
//
// values between points bilinear, min and max of q over the four nodes around p − d(p).
//
// Derivatives are those of the pieces: where the clamp holds, q' is the value of one node, and of
// two equal nodes the earlier, in the order of x; r on its limit counts as free. q' is continuous
// in d except where the clamp holds and p − d crosses from one cell of the lattice to another.
// Owns its work space: use one object per thread. trace() sets the displacements of the points,
// (N²) each; all other functions refer to the last trace.
class Advection {
 public:
  explicit Advection(Index N);

  void trace(VectorRef dx, VectorRef dy);
  // rows(j)(i): of four points, from the i-th of row j on.
  template <class Rows>
  void trace(const Rows& rows) {
    if (!trace_near(rows)) trace_far(rows);
  }

  // All (N²).
  void value(VectorRef q, VectorOut out);  // q'
  void pushforward(VectorRef q, VectorRef vq, VectorRef vdx, VectorRef vdy, VectorOut out);
  // Adds to the cotangents of q, dx, dy those of a cotangent u of q'.
  void pullback(VectorRef q, VectorRef u, VectorOut of_q, VectorOut of_dx, VectorOut of_dy);

  // Between which nodes each point lies, and which limit holds.
  void add_choices(VectorRef q, PieceDigest& digest);

 private:
  // Where the points of the lattice come from, or go to.
  struct Points {
    Eigen::VectorXi
        way;      // (N²) on the padded lattice, to the lower left of the four around a place
    Vector a, b;  // (N²) how far the place lies from there in x and in y, in [0, 1]
  };
  class Places;
  template <class Rows>
  bool trace_near(const Rows& rows);  // back_ and ahead_; false: some lie beyond the margin
  template <class Rows>
  void trace_far(const Rows& rows);
  void keep_far(Index i, Index j, Real x, Real y, Points& out) const;
  void interpolate(VectorRef q);  // s, and the limits of r
  void pull_correction(VectorRef u, Vector& into_q, Vector& into_s, VectorOut of_dx,
                       VectorOut of_dy);
  void pull_interpolation(const Vector& into_s, VectorOut of_dx, VectorOut of_dy);

  Index N_;
  LatticeMargin margin_;
  Index stride_;                    // N and both margins
  Points back_, ahead_;             // p − d and p + d
  Vector least_, most_;             // (N²) of q over the four nodes around p − d
  Vector q_, s_, tangent_, moved_;  // (stride²) padded
  Vector pairs_;                    // (2 stride²) of LatticeMargin::settle
};

// Points for inner loops: pointers that stores in the loop cannot change.
class Advection::Places {
 public:
  explicit Places(Points& points)
      : way_(points.way.data()), a_(points.a.data()), b_(points.b.data()) {}

  void keep(Index p, const Four& ways, const Four& a, const Four& b) const {
    put_ways(ways, way_ + p);
    put(a, a_ + p);
    put(b, b_ + p);
  }
  const int* way(Index p) const { return way_ + p; }
  Four a(Index p) const { return four_at(a_ + p); }
  Four b(Index p) const { return four_at(b_ + p); }

 private:
  int* way_;
  Real *a_, *b_;
};

// The way back is measured from where it ends: −d lies between −⌈d⌉ and 1 − ⌈d⌉.
template <class Rows>
bool Advection::trace_near(const Rows& rows) {
  const Real stride = static_cast<Real>(stride_), reach = static_cast<Real>(LatticeMargin::kReach);
  auto are_near = Four{} == 0;  // a mask
  const Places back(back_), ahead(ahead_);
  for (Index j = 0; j < N_; ++j) {
    const auto row = rows(j);
    margin_.by_fours_of_row(j, [=, &are_near](Index i, Index p) {
      const auto [x, y] = row(i);
      are_near &= (size_of(x) <= reach) & (size_of(y) <= reach);
      const Four left = floor_of(x), lower = floor_of(y);
      const Four right = ceiling_of(x), upper = ceiling_of(y);
      ahead.keep(p, left + stride * lower, x - left, y - lower);
      back.keep(p, -right - stride * upper, right - x, upper - y);
    });
  }
  return are_near[0] && are_near[1] && are_near[2] && are_near[3];
}

template <class Rows>
void Advection::trace_far(const Rows& rows) {
  for (Index j = 0; j < N_; ++j) {
    const auto row = rows(j);
    margin_.by_fours_of_row(j, [&](Index i, Index) {
      const auto [x, y] = row(i);
      for (Index k = 0; k < 4; ++k) {
        keep_far(i + k, j, -x[k], -y[k], back_);
        keep_far(i + k, j, x[k], y[k], ahead_);
      }
    });
  }
}

}  // namespace isoline::problems
