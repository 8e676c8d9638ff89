// The quantities that claims speak of: what is made of the medians over seeds of figures of runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/real.h"

namespace isoline::reports {

// Of terms by their medians: value (of the first), least and greatest, ratio (first over second),
// slope of log m over log at, crossing (where the first half of the terms passes from below the
// second half to above it, in `at`), position (of the first, from 1; a tie counts half), order
// (Kendall's τ with that of the terms). Of the first half of the terms over the second: ratio_slope
// and trend, the slope and the order of these ratios; agreement, Kendall's τ of the two halves.
Real quantity_of(const std::string& kind, const std::vector<Real>& medians,
                 const std::vector<Real>& at);

// The value of a quantity at which it says nothing of a direction; none where there is none.
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
};

// All terms are resampled by the same seeds: a ratio stays one between runs of equal start and
// data.
Measurement measure(const std::string& kind, const std::vector<Term>& terms,
                    const std::string& stream);

}  // namespace isoline::reports
