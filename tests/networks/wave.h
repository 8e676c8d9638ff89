// Arrays given by a formula.
#pragma once

#include "core/array.h"

namespace isoline::networks {

// sin(a i + b), which PyTorch's side of the golden values can draw too.
inline Matrix wave(Index rows, Index columns, Real a, Real b) {
  return (a * Vector::LinSpaced(rows * columns, 0, Real(rows * columns - 1)).array() + b)
      .sin()
      .matrix()
      .reshaped(rows, columns);
}

}  // namespace isoline::networks
