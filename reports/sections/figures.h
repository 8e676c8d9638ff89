// Drawings of runs: curves, paths and fields as the page shows them, and the figures of the
// papers, each panel that a problem's sheet asks for.
#pragma once

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/results/ranking.h"
#include "reports/sections/claims.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using namespace results;

// Columns of equal length. At each iteration the median over seeds of every column; a run that has
// ended keeps its last values, a run without a curve counts as infinite. The gap is what is left of
// the loss, (f − f_L) / s: the τ of the tables is a height in its plot. Of a direct problem it is
// the least so far.
struct MedianCurve {
  std::vector<Real> iteration, work, cost, seconds, gap, x_error;
  std::vector<Real> gap_low, gap_high, x_error_low, x_error_high;  // least and greatest over seeds
  std::vector<bool> is_after_gap;                                  // of stored points
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

// The path of each optimizer, of its run with the median work, and the points of it that are drawn.
struct Path {
  std::size_t optimizer = 0;
  const Run* run = nullptr;
  const Trajectory* points = nullptr;
  std::vector<std::size_t> kept = {};
};
std::vector<Path> paths(const Comparison& comparison, std::size_t problem);
// The length of a path over the distance between its ends, infinite where that says nothing.
Real detour(const std::vector<std::vector<Real>>& path);

// The results of one method of each kind for a problem on a grid, from the fields of its records.
struct FoundField {
  std::size_t optimizer = 0;
  FieldFrames frames;       // with their numbers
  std::vector<Real> apart;  // ‖x − x*‖ / ‖x*‖ of each frame; empty where x* is not known
};
struct FoundFields {
  Quantity x, y;
  std::uint64_t seed = 0;  // of all of them
  bool is_learned = false;
  Real time = 0;                  // where rows are states from x on: of the last one, y; else 0
  Real x_scale = 0, y_scale = 0;  // the greatest |x*| and |y*|; where x* is not known, that of x
  std::vector<FoundField> found;  // the best of each kind on this problem, the best first

  bool is_history() const { return time > 0; }
  const FieldFrames& frames() const { return found.front().frames; }  // y* and x* are all the same
};
// Nothing where no run keeps fields that can be read.
std::optional<FoundFields> found_fields(const Comparison& comparison, std::size_t problem);
using AllFields = std::vector<std::optional<FoundFields>>;  // by problem
AllFields all_found_fields(const Comparison& comparison);

// One method in a paper's figure: y over x, the median over seeds, with its least and greatest.
struct FigureLine {
  std::size_t optimizer = 0;          // index in the comparison
  std::vector<Real> x, y, low, high;  // low and high empty where there is one run a point
};

// A grid as the paper shows it: rows from the top, each of `size` cells.
struct Picture {
  enum class Kind { context, y, x };
  Kind kind = Kind::x;  // those of one kind share a grey scale, of y* or x*
  std::string title;
  Index size = 0;
  std::vector<Real> values;
};

// A value of the paper's, read off its figure or its text, with the error of reading.
struct PublishedMark {
  std::size_t optimizer = 0;  // index in the comparison: of the method that it is of
  std::string name;           // "adam, published: error in x, running mean over 256 steps"
  Real x = 0, y = 0, low = 0, high = 0;
};

struct Figure {
  std::string problem, title, kind;
  std::string x_label, y_label;
  bool is_log_x = false, is_log_y = false;
  bool has_diagonal = false;                              // y = x
  bool is_relative = false;                               // divided by an option of the problem
  std::vector<std::pair<std::string, Real>> places = {};  // of a sweep: problems, with their x
  std::vector<FigureLine> lines;
  std::vector<PublishedMark> published = {};
  std::set<std::size_t> of_the_paper = {};  // optimizers that its claims are about
  std::vector<Picture> pictures;
  std::string reading;  // what it shows, in a sentence of these numbers
};
std::vector<Figure> figures(const Comparison& comparison);

// Draws into them what the papers say: levels of an error in x, and which methods they are of.
void add_published(std::vector<Figure>& all, const Comparison& comparison,
                   const std::vector<Judgement>& claims);

// The window of a plot of lines: as high as medians and what was published go, and of their bands
// no more than thrice that.
struct Window {
  Real x_low = 0, x_high = 1, y_low = 0, y_high = 1;
};
Window window_of(const Plot& plot);

}  // namespace isoline::reports
