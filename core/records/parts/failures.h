// Evaluations that failed, because the simulator did or its y was not finite.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

// How many, and of the first ones x and the reason, which may hold addresses and times.
struct Failures {
  static constexpr Part kPart{.member = "failures",
                              .law = R"({"description": "Evaluations that failed"})",
                              .ignored = "reasons"};
  std::int64_t total = 0;
  std::vector<std::vector<Real>> x = {};
  std::vector<std::string> reasons = {};  // one for each x
};

void fields(Like<Failures> auto& failures, auto& field) {
  field("total", failures.total, kCountLaw);
  field("x", failures.x,
        R"({"description": "Of the first ones, at most 1,000; empty if it is too long"})");
  field("reasons", failures.reasons, R"({"description": "Of each x"})");
}

inline void require_sound(const Failures& failures) {
  require(failures.x.size() == failures.reasons.size() && std::ssize(failures.x) <= failures.total,
          "the numbers of its failed evaluations and of their reasons differ");
}

}  // namespace isoline
