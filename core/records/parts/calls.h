// Calls of a run to the program that computes its problem.
#pragma once

#include <cstdint>

#include "core/records/part.h"

namespace isoline {

// And those by which a verifier computed the returned point again. What the store answers depends
// on earlier runs.
struct Calls {
  static constexpr Part kPart{.member = "calls",
                              .law = R"({"description": "To a problem of another program"})",
                              .ignored = "*"};
  std::int64_t made = 0, answered = 0;  // answered by the store of evaluations
  std::int64_t verified = 0, failed = 0;
};

void fields(Like<Calls> auto& calls, auto& field) {
  field("made", calls.made, kCountLaw);
  field("answered", calls.answered,
        R"({"type": "integer", "minimum": 0, "description": "From the store of evaluations"})");
  field(
      "verified", calls.verified,
      R"({"type": "integer", "minimum": 0, "description": "Made again by the verifier for the returned point; with none, verified is null"})");
  field("failed", calls.failed, R"({"type": "integer", "minimum": 0, "description": "Of these"})");
}

}  // namespace isoline
