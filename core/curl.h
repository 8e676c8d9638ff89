// The curl of a velocity on a periodic grid, for pictures of flows.
#pragma once

#include "core/array.h"

namespace isoline {

// ∂v/∂i − ∂u/∂j by central differences, in units of a cell: u and v are the first and second half
// of `velocity`, each (rows · columns), column by column. (rows · columns)
Vector curl(VectorRef velocity, Index rows, Index columns);

}  // namespace isoline
