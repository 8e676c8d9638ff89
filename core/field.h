// The fields x and y of a problem, and the figures that a problem requests.
#pragma once

#include <map>
#include <string>

#include "core/real.h"

namespace isoline {

struct Quantity {
  std::string name;       // "initial temperature"
  std::string unit = {};  // empty: a pure number
};

// x and y (rows · columns, samples), the cells column by column. Where `time` is above 0 a row is a
// state: x (columns, samples) the first one, at 0, and y the last, with evenly spread ones between.
// `context`, where it is named, is the first rows · columns numbers of a sample's context.
struct Field {
  Index rows = 0, columns = 0;
  Quantity x, y;
  Real time = 0;
  std::string context = {};

  bool is_history() const { return time > 0; }
};

// A figure of a problem's runs, in the form of the paper's figure.
struct Panel {
  std::string title;  // "Fig. 5d: error over ξ"
  // "curve": error in x against iterations. "sweep": the error at the end over the option `over`,
  // divided by the option `divided_by` where that is named. "scatter": x inferred against x*.
  // "decades": error by decade of y*. "pictures": y*, each method's x, and x*. "series": a quantity
  // against iterations. "path": a quantity against another, "a|b".
  std::string kind;
  std::map<std::string, double> where = {};  // numbers that a problem's options must have
  std::string over = {}, divided_by = {};
  std::string quantity = {};
};

}  // namespace isoline
