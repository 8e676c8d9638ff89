// When a measurement agrees with what was published: the law of the verdicts.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "reports/sections/quantities.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {

// From the strongest to the weakest, then those that are none.
enum class Verdict { reproduced, consistent, partly, not_reproduced, too_short, not_comparable };
inline constexpr std::array<std::string_view, 6> kVerdictNames = {
    "reproduced", "consistent", "partly", "not reproduced", "too short", "not comparable"};
inline std::string_view name_of(Verdict verdict) {
  return kVerdictNames[static_cast<std::size_t>(verdict)];
}
inline bool is_decided(Verdict verdict) { return verdict < Verdict::too_short; }

// What was published with its error: the values that agree with it. A tie agrees with nothing that
// says who is ahead, so such a band ends where the tie begins, without it.
struct Agreement {
  Real low = -kNever, high = kNever;
  bool is_low_open = false, is_high_open = false;

  bool holds(Real value) const {
    return (is_low_open ? value > low : value >= low) &&
           (is_high_open ? value < high : value <= high);
  }
};
Agreement agreement_of(const nlohmann::json& claim);  // or of a contrast

// Of a claim, or of its contrast. Reproduced: the interval over seeds lies within the band.
// Consistent: it reaches into the band, and the value is on the published side of a tie. Partly:
// the whole interval is on that side, and the value between a third and three times the published
// effect (in logarithms, of a ratio). One run of several that could have been drawn is never more
// than consistent.
Verdict verdict_of(const Measurement& measured, const nlohmann::json& claim, bool is_drawn);

}  // namespace isoline::reports
