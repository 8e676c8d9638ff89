// The results of a learning run on some validation samples, one per column.
#pragma once

#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

struct Exhibit {
  static constexpr Part kPart{.member = "exhibit"};
  Grid target, x, truth;
};

void fields(Like<Exhibit> auto& exhibit, auto& field) {
  field("target", exhibit.target);
  field("x", exhibit.x);
  field("truth", exhibit.truth);
}

}  // namespace isoline
