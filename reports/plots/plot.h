// A plot of statistics: its numbers, computed once, and the sentence that reads them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/array.h"

namespace isoline::reports {

// The part of one optimizer. Steps: y(x) from each x on, with a band. Dots: x with its interval in
// the row y. Bars: y in the row x. Matrix: y of the row in the column x.
struct PlotSeries {
  std::size_t optimizer = 0;
  std::string name;
  std::vector<Real> x, y, low, high;  // low and high may be empty; not-a-number: nothing there
};

struct PlotRow {
  std::string name;
  std::optional<std::size_t> optimizer, problem;  // what it stands for
};

struct Plot {
  enum class Kind { steps, dots, bars, matrix };
  Kind kind = Kind::steps;
  std::string id, title;
  std::string reading;  // a sentence on this very data
  std::string caption;  // what is drawn, of how many, and how many of them failed
  std::string x_label, y_label;
  bool is_log_x = false;
  std::vector<PlotRow> rows = {};  // of dots, bars and matrix
  std::vector<PlotSeries> series = {};
};

}  // namespace isoline::reports
