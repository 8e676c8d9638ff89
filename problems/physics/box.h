// Bounds on x, component by component.
#pragma once

#include "core/array.h"

namespace isoline::problems {

struct Box {
  Vector lower, upper;  // (k) each, or empty where x may be anything

  bool is_everything() const { return lower.size() == 0; }
  bool holds(VectorRef x) const {
    return is_everything() || ((x.array() >= lower.array()) && (x.array() <= upper.array())).all();
  }
  // What is no number is moved to a lower bound.
  Vector nearest(VectorRef x) const {
    if (is_everything()) return x;
    const Vector above = (x.array() > lower.array()).select(x, lower);
    return (above.array() < upper.array()).select(above, upper);
  }
};

}  // namespace isoline::problems
