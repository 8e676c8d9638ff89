// An arithmetic expression of the unknowns of a problem, with its gradient: "2 * k1 + exp(-E
// / 8.314)".
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/array.h"

namespace isoline::problems {

// Numbers, names, + - * / ^, parentheses, and exp, log, log10, sqrt, sin, cos, tan, abs. A name
// consists of letters, digits and _, and begins with no digit. UsageError, with the place, where
// the text is something else.
class Expression {
 public:
  struct Value {
    Real value = 0;
    Vector by;  // ∂value/∂x, (k)
  };
  Expression(std::string_view text, const std::vector<std::string>& names);
  Value operator()(const Vector& x) const { return evaluate_(x); }

 private:
  std::function<Value(const Vector& x)> evaluate_;
};

}  // namespace isoline::problems
