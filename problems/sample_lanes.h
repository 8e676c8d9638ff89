// Eight samples side by side in vector registers: for physics that take the same few hundred steps
// for every sample. The last samples of a batch go with zeros beside them; no lane sees another.
#pragma once

#include <algorithm>

#include "core/array.h"

namespace isoline::problems {

inline constexpr Index kLanes = 8;
using Lanes = Eigen::Array<Real, kLanes, 1>;
template <Index components>
using LanesOf = Eigen::Array<Real, kLanes, static_cast<int>(components)>;  // one per column

inline Index groups_of_lanes(Index samples) { return (samples + kLanes - 1) / kLanes; }

// visit(group, first, count): the samples from `first` on, eight but for the last group.
template <class Visit>
void by_lanes(Index samples, const Visit& visit) {
  for (Index first = 0; first < samples; first += kLanes)
    visit(first / kLanes, first, std::min(kLanes, samples - first));
}

// Columns of samples, (k, B), to rows of lanes, (8, k), and back.
template <class Rows>
void gather(BatchRef from, Index first, Index count, Rows&& lanes) {
  lanes.bottomRows(kLanes - count).setZero();
  lanes.topRows(count).matrix() = from.middleCols(first, count).transpose();
}
template <class Rows>
void scatter(const Rows& lanes, Index first, Index count, BatchOut to) {
  to.middleCols(first, count) = lanes.topRows(count).transpose().matrix();
}

// Columns of a matrix with eight rows as lanes.
template <Index components = 1>
Eigen::Map<LanesOf<components>> lanes_at(Matrix& rows, Index column) {
  return Eigen::Map<LanesOf<components>>(&rows(0, column));
}

}  // namespace isoline::problems
