// The path in x and y, at the iterations of the curve; where x and y are small.
#pragma once

#include <vector>

#include "core/errors.h"
#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

struct Trajectory {
  static constexpr Part kPart{.member = "trajectory"};
  std::vector<std::vector<Real>> x = {}, y = {};
};

void fields(Like<Trajectory> auto& path, auto& field) {
  field("x", path.x);
  field("y", path.y);
}

// `points`: of the curve.
inline void require_sound(const Trajectory& path, std::size_t points) {
  require(path.x.size() == points && path.y.size() == points,
          "the columns of its curve differ in length");
}

}  // namespace isoline
