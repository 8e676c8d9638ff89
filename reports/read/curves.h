// Learning curves and paths as the page draws them: medians over seeds, thinned.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/results/ranking.h"

namespace isoline::reports {

using namespace results;

// Columns of equal length. At each iteration the median over seeds of every column; a run that has
// ended keeps its last values, a run without a curve counts as infinite. The gap is what is left of
// the loss, (f − f_L) / s: the τ of the tables is a height in its plot. Of a direct problem it is
// the least so far.
struct MedianCurve {
  std::vector<Real> iteration, work, cost, seconds, gap, x_error;
  std::vector<Real> gap_low, gap_high, x_error_low, x_error_high;  // least and greatest over seeds
};
MedianCurve median_curve(const Comparison& comparison, const Cell& cell, std::size_t points);

// `count` of the indices 0 … size − 1, both ends among them, spaced evenly in the logarithm.
std::vector<std::size_t> thinned(std::size_t size, std::size_t count);

// The last kept point at or before a place on an axis of a curve, or its first one.
template <class Value>
std::size_t point_at(const std::vector<Value>& axis, Value place) {
  const std::ptrdiff_t passed = std::ranges::upper_bound(axis, place) - axis.begin();
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, passed) - 1);
}

// The path of the lowest seed that has one; empty where none has.
struct Path {
  std::string optimizer;
  std::size_t index = 0;  // of the optimizer
  std::vector<std::vector<Real>> x, y;
};
std::vector<Path> paths(const Comparison& comparison, std::size_t problem);

// How far a path strays: its length over the distance between its ends, infinite where that says
// nothing.
Real detour(const std::vector<std::vector<Real>>& path);

}  // namespace isoline::reports
