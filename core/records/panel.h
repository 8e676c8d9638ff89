// A figure that a problem wants drawn of its runs, as the paper it is from draws it.
#pragma once

#include <map>
#include <string>

namespace isoline {

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
