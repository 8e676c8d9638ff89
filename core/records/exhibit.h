// What a learning run makes of its validation: some small samples, one a column. Older records have
// instead one sample as N×N grids, in an array (3, N, N) of y*, x and x* in `.npy` beside them.
#pragma once

#include "core/grid.h"

namespace isoline {

struct Exhibit {
  Index grid = 0;         // N of older records, or 0
  Grid target, x, truth;  // one sample a column

  bool is_picture() const { return grid > 0; }
};

}  // namespace isoline
