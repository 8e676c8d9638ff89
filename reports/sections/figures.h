// The figures of the papers, from the runs of a study: each panel that a problem's sheet asks for.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/results/ranking.h"
#include "reports/sections/evidence.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using namespace results;

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

struct Window {
  Real x_low = 0, x_high = 1, y_low = 0, y_high = 1;
};

// As high as medians and what was published go, and of their bands no more than thrice that.
Window window_of(const Plot& plot);

}  // namespace isoline::reports
