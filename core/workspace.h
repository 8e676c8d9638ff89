// What a forward pass leaves behind for the products that follow it. Owned by the caller, so that
// physics and networks stay const; sized at first use, so that hot loops allocate nothing.
#pragma once

#include <vector>

#include "core/array.h"

namespace isoline {

struct Workspace {
  Matrix x;                       // (k, B) input of the last forward
  Matrix context;                 // (p, B) context of the last forward, empty for most
  std::vector<Matrix> saved;      // whatever else the component keeps; its own business
  bool saved_is_current = false;  // whether `saved` belongs to x; false after each forward
};

}  // namespace isoline
