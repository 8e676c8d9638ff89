// The runs that stand for the terms of a claim: which they are, and what is read off them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "reports/sections/quantities.h"
#include "reports/sections/run_figures.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {

using ByCell = std::unordered_map<std::string, const Record*>;

std::vector<std::string> cells_of(const nlohmann::json& set);  // digests
// Cells of a set that have no record, in words.
std::vector<std::string> missing_cells(const nlohmann::json& set, const ByCell& runs);

// Where a term of a claim, or of its contrast, is read.
Place place_of(const nlohmann::json& claim, const nlohmann::json& term);

// What a claim must not survive, beside optimizers that go by each other's names.
enum class Null {
  none,
  untrained,  // nothing was learned: each figure is that of iteration 0
  twins       // one method under several names: all terms of a problem are the same run
};

// The figures of a claim's terms, or of its contrast's. `cells` is a list of terms, each a list of
// alternatives, as verdicts.h says. Where the claim asks for equal time, all are read at that at
// which the fastest has made `iterations`.
std::vector<Term> terms_of(const nlohmann::json& claim, const nlohmann::json& cells,
                           const ByCell& runs, std::int64_t iterations, Null null = Null::none);

// The processor time of each seed at which the fastest run of it has made so many iterations: a run
// is charged at its own measured price, also where it stopped before.
std::vector<Real> equal_seconds(const nlohmann::json& cells, const ByCell& runs,
                                std::int64_t iterations);

// Whether terms of one problem are of several optimizers, in the claim or in what it is held
// against: else none can be taken for another.
bool has_rivals(const nlohmann::json& claim);

}  // namespace isoline::reports
