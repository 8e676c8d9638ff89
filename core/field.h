// What x and y of a problem are, where each is a number a cell of one grid, or the first and last
// of the states of a line: for pictures of them.
#pragma once

#include <string>

#include "core/real.h"

namespace isoline {

struct Quantity {
  std::string name;       // "temperature before"
  std::string unit = {};  // empty: a pure number
};

// x and y (rows · columns, samples), the cells column by column. Where `time` is above 0 a row is a
// state: x (columns, samples) the first one, at 0, and y the last, with evenly spread ones between.
struct Field {
  Index rows = 0, columns = 0;
  Quantity x, y;
  Real time = 0;

  bool is_history() const { return time > 0; }
};

}  // namespace isoline
