// Numbers and their places, for files that need no arrays.
#pragma once

#include <cstddef>

namespace isoline {

using Real = double;
using Index = std::ptrdiff_t;  // Eigen's

}  // namespace isoline
