// Values between the nodes of a lattice, for one point or for four of a row side by side in vector
// registers: an algorithm written for T is that of either.
#pragma once

#include "core/array.h"

namespace isoline::problems {

// What is loose may lie anywhere in an array of double.
using Four = double __attribute__((vector_size(32)));
using Pair = double __attribute__((vector_size(16)));
using LooseFour = double __attribute__((vector_size(32), aligned(8), may_alias));
using LoosePair = double __attribute__((vector_size(16), aligned(8), may_alias));

inline Pair pair_at(const Real* from) { return *reinterpret_cast<const LoosePair*>(from); }
inline Four four_at(const Real* from) { return *reinterpret_cast<const LooseFour*>(from); }
inline void put(const Four& values, Real* to) { *reinterpret_cast<LooseFour*>(to) = values; }
inline void add(const Four& values, Real* to) { *reinterpret_cast<LooseFour*>(to) += values; }

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

// Two of a row lie side by side: eight pairs, and their transpose.
inline Nodes<Four> nodes_at(const Real* q, const int* node, Index stride) {
  const auto turned = [&](const Real* row, Four& left, Four& right) {
    const Four even =
        __builtin_shufflevector(pair_at(row + node[0]), pair_at(row + node[2]), 0, 1, 2, 3);
    const Four odd =
        __builtin_shufflevector(pair_at(row + node[1]), pair_at(row + node[3]), 0, 1, 2, 3);
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
[[gnu::always_inline]] inline void add_pairs(const Four& left, const Four& right, const int* node,
                                             Real* pairs) {
  const Four even = __builtin_shufflevector(left, right, 0, 4, 2, 6);
  const Four odd = __builtin_shufflevector(left, right, 1, 5, 3, 7);
  const auto add_pair = [pairs](Index n, const Pair& shares) {
    *reinterpret_cast<LoosePair*>(pairs + 2 * n) += shares;
  };
  add_pair(node[0], __builtin_shufflevector(even, even, 0, 1));
  add_pair(node[1], __builtin_shufflevector(odd, odd, 0, 1));
  add_pair(node[2], __builtin_shufflevector(even, even, 2, 3));
  add_pair(node[3], __builtin_shufflevector(odd, odd, 2, 3));
}

// Adds the transpose of Nodes::mean for four points. Were the nodes themselves added to two at a
// time, a load would often hang on two stores, one node off: pairs have a place each.
[[gnu::always_inline]] inline void spread(const Four& u, const Four& a, const Four& b,
                                          const int* node, Index stride, Real* pairs) {
  const Four lower = (1 - b) * u, upper = b * u;
  add_pairs((1 - a) * lower, a * lower, node, pairs);
  add_pairs((1 - a) * upper, a * upper, node, pairs + 2 * stride);
}

inline Four floor_of(const Four& x) {
  const Eigen::Map<const Eigen::Array4d> each(reinterpret_cast<const Real*>(&x));
  const Eigen::Array4d whole = each.floor();
  return four_at(whole.data());
}

inline void put_nodes(const Four& nodes, int* to) {
  using LooseNodes = int __attribute__((vector_size(16), aligned(4), may_alias));
  *reinterpret_cast<LooseNodes*>(to) = __builtin_convertvector(nodes, LooseNodes);
}

}  // namespace isoline::problems
