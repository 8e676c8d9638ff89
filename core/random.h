// Arrays of counter-based random numbers.
#pragma once

#include "core/array.h"
#include "core/draws.h"

namespace isoline {

class RandomStream : public Draws {
 public:
  using Draws::Draws;

  // The stream of another sample, from its beginning; everything else of the key the same.
  RandomStream of_sample(std::uint64_t index) const;

  Vector normal_vector(Index n);  // (n) independent N(0, 1)
  Vector uniform_vector(Index n, Real low, Real high);
  void signs(VectorOut out);  // each −1 or 1 with equal chance
};

}  // namespace isoline
