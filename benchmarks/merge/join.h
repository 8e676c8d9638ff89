// The join of two records of one cell and build: the arithmetic under `isoline merge`.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/records/plan.h"

namespace isoline::benchmarks {

// Associative, commutative and idempotent. Where the results differ `difference` tells the first
// places, and what is returned means nothing.
struct JoinedRecord {
  std::shared_ptr<const Json> record;
  std::string difference;
  bool is_provenance_other = false;  // that of the run aside
};
JoinedRecord join_records(const Json& a, const Json& b);

// The union of two plans, sorted; suites and cells once each.
Plan join_plans(const Plan& a, const Plan& b);

// The union of two lists of the rates that plans used, sorted; of two wordings of one row the
// lesser text stays.
Json join_rates(const Json& a, const Json& b);

// Whether sheets of one component, as JSON texts, differ in more than measured prices: no two
// measurements are alike.
bool have_other_wordings(const std::vector<std::string>& sheets);

}  // namespace isoline::benchmarks
