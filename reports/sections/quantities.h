// The quantities that claims speak of: one figure of one run, and what is made of medians over
// seeds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/records/record.h"

namespace isoline::reports {

// Where a figure of a run is read: a column of its curve or a quantity of its path, at an
// iteration, or when so much processor time has passed, or at the end where neither is named.
struct Place {
  std::string column;  // "series: …" is a quantity of the problem's own
  std::optional<std::int64_t> iteration;
  std::optional<Real> seconds;
  std::vector<std::vector<Real>> table;  // of deviations: at iterations 1, 2, …; one row: there
};

// A printed row of figures and the point of the path that stands beside it.
struct PrintedRow {
  std::int64_t iteration = 0;
  std::vector<Real> printed, reached;
};
// Of a table at iterations 1, 2, …; a single row is held against the place's iteration. None where
// the path is shorter.
std::vector<PrintedRow> printed_rows(const Record& record, const Place& place);

// Not-a-number where the record does not hold it.
Real figure_of(const Record& record, const Place& place);
std::string column_words(const std::string& column);  // "error in x"

// Of terms by their medians: value (of the first), greatest, ratio (first over second), slope of
// log m over log at, crossing (where the first half of the terms passes from below the second half
// to above it, in `at`), position (of the first, from 1; a tie counts half), order (Kendall's τ
// with that of the terms).
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
