// Sums of two neighbours on a periodic N×N grid, (N²) with x running fastest: of them are made the
// means between faces and centres, the differences of projection and viscosity, and their adjoints,
// for the transpose of a sum with one neighbour is the sum with the opposite one.
#pragma once

#include "core/array.h"

namespace isoline::problems {

enum class Side { left, right, below, above };
constexpr Side opposite(Side side) {
  constexpr Side kOpposite[] = {Side::right, Side::left, Side::above, Side::below};
  return kOpposite[static_cast<int>(side)];
}

// out = a q + b (q of the neighbour on that side), or out += that. `out` is never q.
void weigh(Index N, Real a, Real b, Side side, VectorRef q, VectorOut out);
void add_weighed(Index N, Real a, Real b, Side side, VectorRef q, VectorOut out);

// out += a times the sum of the four in the square that lies towards a side across, left or right,
// and one along, below or above.
void add_square(Index N, Real a, Side across, Side along, VectorRef q, VectorOut out);

}  // namespace isoline::problems
