// The runs that stand for the terms of a claim: which they are, and what is read off them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/real.h"
#include "core/records/record.h"
#include "core/results/ranking.h"
#include "core/results/statistics.h"
#include "reports/sections/quantities.h"

namespace isoline::reports {

using namespace results;

// One figure of one run: what the quantities of claims are made of.

// Where a figure of a run is read: a column of its curve or a quantity of its path, at an
// iteration, or when so much processor time has passed or work been counted, or at the end where
// none is named.
struct Place {
  std::string column;  // "series: …" is a quantity of the problem's own
  std::optional<std::int64_t> iteration;
  std::optional<Real> seconds;
  std::optional<std::int64_t> work;
  std::vector<std::vector<Real>> table;  // of deviations: at iterations 1, 2, …; one row: there
};

// A printed row of figures and the point of the path that stands beside it.
struct PrintedRow {
  std::int64_t iteration = 0;
  std::vector<Real> printed, reached;
};
// A table at iterations 1, 2, …; a single row is compared at the place's iteration. Nothing if
// the path is shorter.
std::vector<PrintedRow> printed_rows(const Record& record, const Place& place);

// The last kept point at or before the place.
std::size_t index_at(const Curve& curve, const Place& place);

// "until: loss 0.1" is what was spent until the loss was no more than 0.1: the column, the bound.
std::pair<std::string, Real> bound_of(const std::string& column);

// Not-a-number where the record does not hold it.
Real figure_of(const Record& record, const Place& place);
std::string column_words(const std::string& column);  // "error in x"

std::string tau_name(const Comparison& comparison);  // "1e-6", the headline's

// "work", "measured cost", "iterations", "wall time".
std::string_view counted_name(Measure by);
std::string_view counted_name(const Comparison& comparison);
std::string_view unit_name(Measure by);  // "forward solves", …, "ms"
std::string_view unit_name(const Comparison& comparison);

// "work to 1e-6, in forward solves", "iterations to 1e-6".
std::string counted_to_tau(const Comparison& comparison);

// An amount as tables write it, ✗ where infinite: times are given in seconds and told in ms.
std::string amount(Measure by, Real value);
std::string amount(const Comparison& comparison, Real value);
// "≈" where it is a time that was taken while other runs shared the machine.
std::string_view time_mark(const Comparison& comparison, const Cell& cell);

// A row of a study is a setting where some problem has several: "problem" or "setting".
std::string_view setting_noun(const Comparison& comparison);
std::string_view common_noun(const Comparison& comparison);  // of the settings of the common order
std::string n_column(const Comparison& comparison);  // "n settings", the heading of their number
std::string counted_settings(const Comparison& comparison, std::size_t count);  // "22 settings"

// The meaning of success by this measure, as a sentence; with a single criterion, for that only.
std::string success_text(const Comparison& comparison);

using ByCell = std::unordered_map<std::string, const Record*>;

std::vector<std::string> cells_of(const nlohmann::json& set);  // digests
// Cells of a set that have no record, in words.
std::vector<std::string> missing_cells(const nlohmann::json& set, const ByCell& runs);

// Where a term of a claim, or of its contrast, is read.
Place place_of(const nlohmann::json& claim, const nlohmann::json& term);

// The comparisons that must refute a claim, besides permuted names of optimizers.
enum class Null {
  none,
  untrained,  // nothing was learned: each figure is that of iteration 0
  twins       // one method under several names: all terms of a problem are the same run
};

// Where a claim is read, and where else because its verdict must not hang on that: a time is that
// of a machine, and the published runs of the sine had a time, in which SIP made a third of the
// iterations of others.
enum class ReadAt { asked, equal_work, third_of_sip };

// The figures of a claim's terms, or of a contrast's. `cells` is a list of terms, each a list of
// alternatives. Where the claim asks for equal time, all are read at the time at which the fastest
// has made `iterations`.
std::vector<Term> terms_of(const nlohmann::json& claim, const nlohmann::json& cells,
                           const ByCell& runs, std::int64_t iterations, Null null = Null::none,
                           ReadAt at = ReadAt::asked);

// The processor time of each seed, or its counted work, at which the cheapest run of it has made so
// many iterations: a run is charged at its own price, also where it stopped before.
std::vector<Real> equal_spending(const nlohmann::json& cells, const ByCell& runs,
                                 std::int64_t iterations, bool is_work);

// Whether terms of one problem are of several optimizers, in the claim or in what it is held
// against: else none can be taken for another.
bool has_rivals(const nlohmann::json& claim);

// A claim in words: what it measures, what was published with which error, and where.

// For a claim, or for its contrast.
std::string quantity_text(
    const nlohmann::json& claim);  // "ratio of the loss, at the end: adam / sip"
std::string published_text(const nlohmann::json& claim);  // "≥ 3 (±5 % from text)"
Real published_value(const nlohmann::json& published);

std::string source_text(const nlohmann::json& source);  // of a claim alone
std::string reading_text(const nlohmann::json& claim);  // of what was read off a figure, else empty

}  // namespace isoline::reports
