// One figure of one run: what the quantities of claims are made of.
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

// The last kept point at or before the place.
std::size_t index_at(const Curve& curve, const Place& place);

// Not-a-number where the record does not hold it.
Real figure_of(const Record& record, const Place& place);
std::string column_words(const std::string& column);  // "error in x"

}  // namespace isoline::reports
