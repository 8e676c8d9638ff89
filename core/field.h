// What x and y of a problem are, where each is a number a cell of one grid: for pictures of them.
#pragma once

#include <string>

#include "core/real.h"

namespace isoline {

struct Quantity {
  std::string name;       // "temperature before"
  std::string unit = {};  // empty: a pure number
};

// x and y (rows · columns, samples), the cells column by column.
struct Field {
  Index rows = 0, columns = 0;
  Quantity x, y;
};

}  // namespace isoline
