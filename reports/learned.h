// Learning problems: the error in x beside the loss in y, and where the two rank methods
// differently, the limitation that Holl, Koltun, Thuerey (2022) name themselves.
#pragma once

#include <string>
#include <vector>

#include "reports/comparison.h"

namespace isoline::reports {

struct LearnedRow {
  std::size_t optimizer = 0;
  Spread x_error, loss;             // on the validation, after the last iteration, over seeds
  Real iterations = 0;              // median
  Real milliseconds_each = kNever;  // median time of an iteration
  std::size_t runs = 0, failed = 0;
  bool is_timed_alone = true;
};

struct LearnedProblem {
  std::size_t problem = 0;
  std::vector<LearnedRow> rows;  // by median error in x
  bool ranks_differ = false;     // the least loss and the least error are of different methods
  std::string reading;
};

std::vector<LearnedProblem> learned_problems(const Comparison& comparison);

std::string learned_html(const Comparison& comparison);
std::string learned_markdown(const Comparison& comparison);  // empty without learning problems

}  // namespace isoline::reports
