// The differences by which J came.
#pragma once

#include <optional>

#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

// The noise of y in a call, relative to ‖y‖, and the step that followed from it, relative to the
// sizes of the unknowns; none where the options give the steps.
struct Differences {
  static constexpr Part kPart{
      .member = "differences",
      .law =
          R"({"description": "Of a J by differences: noise of y in a call, and step, relative"})"};
  Real noise = 0;
  std::optional<Real> step;
};

void fields(Like<Differences> auto& differences, auto& field) {
  field("noise", differences.noise, kCountLaw);
  field.optional("step", differences.step, kCountLaw);
}

}  // namespace isoline
