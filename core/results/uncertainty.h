// When a run's standard deviations mean something, and the intervals that follow from them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/records/record.h"

namespace isoline::results {

// χ² of the residuals where the noise of the data is known and normal, and P(χ² ≥ that).
struct NoiseTest {
  Real chi_square = 0, p = 1;
  std::size_t freedom = 0;
};
std::optional<NoiseTest> noise_test(const Record& record);

inline constexpr Real kLeastP = 0.001;  // below it the residuals contradict the noise

enum class Doubt { none, not_minimum, contradicted, unknown };
// The reason why a returned point has no standard deviations: its run did not end at a confirmed
// minimum, its residuals contradict the noise of the data, or none were computed.
Doubt doubt_of(const Record& record);

// Whether methods saw the logarithm of the unknown.
bool has_log(const Record& record, const std::string& name);

// x ± t s, 95 %; of an unknown of the option log, symmetric in the logarithm. Not-a-number without
// s.
struct XInterval {
  Real half = 0, low = 0, high = 0;
};
std::vector<XInterval> intervals_of(const Record& record);  // requires record.uncertainty

}  // namespace isoline::results
