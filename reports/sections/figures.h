// The figures of the papers, from the runs of a study: each panel that a problem's sheet asks for.
#pragma once

#include <string>
#include <vector>

#include "reports/read/comparison.h"

namespace isoline::reports {

// One method: y over x, the median over seeds, with its least and greatest.
struct FigureLine {
  std::size_t optimizer = 0;          // index in the comparison
  std::vector<Real> x, y, low, high;  // low and high empty where there is one run a point
};

// A grid as the paper shows it: rows from the top, each of `size` cells.
struct Picture {
  std::string title;
  Index size = 0;
  std::vector<Real> values;
};

struct Figure {
  std::string problem, title, kind;
  std::string x_label, y_label;
  bool is_log_x = false, is_log_y = false;
  bool has_diagonal = false;  // y = x
  std::vector<FigureLine> lines;
  std::vector<Picture> pictures;
  std::string reading;  // what it shows, in a sentence of these numbers
};

std::vector<Figure> figures(const Comparison& comparison);

}  // namespace isoline::reports
