// Which runs stand for the terms of a claim, and where their figures are read. `claim` is a claim
// or its contrast; a set of cells is one of the claim's, as verdicts.h says.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "reports/sections/quantities.h"

namespace isoline::reports {

using ByCell = std::unordered_map<std::string, const Record*>;  // runs by their digests

Place place_of(const nlohmann::json& claim, const nlohmann::json& term);

// `cells` are those of the terms: of each its alternatives.
std::vector<Term> terms_of(const nlohmann::json& claim, const nlohmann::json& cells,
                           const ByCell& runs);

std::vector<std::string> cells_of(const nlohmann::json& set);  // digests
// Of those that have no record, the titles, each once.
std::vector<std::string> missing_cells(const nlohmann::json& set, const ByCell& runs);

}  // namespace isoline::reports
