// The quantities that claims speak of: what is made of the medians over seeds of figures of runs,
// and when it agrees with what was published.
#pragma once

#include <algorithm>
#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/real.h"
#include "core/results/statistics.h"

namespace isoline::reports {

using namespace results;

// Quantities of terms by their medians: value (of the first), greatest, ratio (first over second),
// slope of log m over log at, crossing (where the first half of the terms passes from below the
// second half to above it, in `at`), position (of the first, from 1; a tie counts half), order
// (Kendall's τ with that of the terms). Of the first half of the terms over the second: ratio_slope
// and trend, the slope and the order of these ratios.
Real quantity_of(const std::string& kind, const std::vector<Real>& medians,
                 const std::vector<Real>& at);

// The value of a quantity that indicates no direction; nothing if it has no such value.
std::optional<Real> neutral_of(const std::string& kind);

// One term of a quantity: figures [alternative][seed], of which the alternative of the least median
// counts, or that of the greatest.
struct Term {
  std::vector<std::vector<Real>> figures;
  Real at = 1, scale = 1;  // its abscissa, and a factor of its figures
  bool is_worst = false;
};

// Which alternative of a term counts over all seeds, and the scaled median of its figures.
struct Chosen {
  std::size_t alternative = 0;
  Real level = 0;
};
Chosen chosen_of(const Term& term);

struct Measurement {
  Real value = 0;
  Real low = 0, high = 0;  // 95 % of the bootstrap over seeds, of few their range; nan of one
  std::size_t n = 0;       // seeds
  std::optional<Interval> predicted = {};  // 95 % of one further run, where logarithms tell
};

// All terms are resampled by the same seeds: a ratio stays one between runs of equal start and
// data.
Measurement measure(const std::string& kind, const std::vector<Term>& terms,
                    const std::string& stream);

// When a measurement agrees with what was published: the law of the verdicts.

// From the strongest to the weakest, then those that are none.
enum class Verdict {
  stronger,
  reproduced,
  consistent,
  partly,
  at_odds,  // too few seeds for more
  not_reproduced,
  too_short,
  undecidable,  // what a run would need was not published
  not_comparable
};
inline constexpr std::array<std::string_view, 9> kVerdictNames = {
    "stronger than published", "reproduced", "consistent",  "partly",        "at odds",
    "not reproduced",          "too short",  "undecidable", "not comparable"};
inline std::string_view name_of(Verdict verdict) {
  return kVerdictNames[static_cast<std::size_t>(verdict)];
}
inline bool is_decided(Verdict verdict) { return verdict < Verdict::too_short; }
inline bool is_supported(Verdict verdict) { return verdict <= Verdict::consistent; }
// Combines two readings of one claim: the weaker, or neither if one is for it and one against it.
inline Verdict joint_verdict(Verdict one, Verdict other) {
  if (is_supported(one) != is_supported(other)) return Verdict::consistent;
  return std::max(one, other);
}

// The published value with its error: the values that agree with it. A tie does not agree with a
// claim about which is better, so such a band ends where the tie begins, without it.
struct Agreement {
  Real low = -kNever, high = kNever;
  bool is_low_open = false, is_high_open = false;

  bool holds(Real value) const {
    return (is_low_open ? value > low : value >= low) &&
           (is_high_open ? value < high : value <= high);
  }
};
Agreement agreement_of(const nlohmann::json& claim);  // or of a contrast

// For a claim, or for its contrast. Reproduced: the interval over seeds lies within the band; where
// the published figure is of one run, the band reaches into what one further run of ours would
// give, the interval is on the published side of a tie, and the value is of the published order.
// Consistent: it reaches into the band, and the value is on that side. Stronger: the whole interval
// is beyond the band where the claim says that further is better. Partly: the whole interval is on
// the published side, and the value between a third and three times the published effect (in
// logarithms, of a ratio). Of fewer than six runs that were drawn it is consistent or at odds.
Verdict verdict_of(const Measurement& measured, const nlohmann::json& claim, bool is_drawn);

}  // namespace isoline::reports
