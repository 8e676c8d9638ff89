// The results of one method of each kind for a problem on a grid, from the fields beside its
// records.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/results/ranking.h"

namespace isoline::reports {

using namespace results;

struct FoundField {
  std::size_t optimizer = 0;
  FieldFrames frames;       // with their numbers
  std::vector<Real> apart;  // ‖x − x*‖ / ‖x*‖ of each frame; empty where x* is not known
};

struct FoundFields {
  Quantity x, y;
  std::uint64_t seed = 0;  // of all of them
  bool is_learned = false;
  Real time = 0;                  // where rows are states from x on: of the last one, y; else 0
  Real x_scale = 0, y_scale = 0;  // the greatest |x*| and |y*|; where x* is not known, that of x
  std::vector<FoundField> found;  // the best of each kind on this problem, the best first

  bool is_history() const { return time > 0; }
  const FieldFrames& frames() const { return found.front().frames; }  // y* and x* are all the same
};

// Nothing where no run keeps fields that can be read.
std::optional<FoundFields> found_fields(const Comparison& comparison, std::size_t problem);
using AllFields = std::vector<std::optional<FoundFields>>;  // by problem
AllFields all_found_fields(const Comparison& comparison);

}  // namespace isoline::reports
