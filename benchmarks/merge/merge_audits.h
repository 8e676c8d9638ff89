// The union of the folders' audits: an optimizer once, as all that audited it measured it.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/merge/conflicts.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

struct AuditUnion {
  std::shared_ptr<const Json> json;  // the file; null where no folder has one
  std::set<std::string> disputed;    // optimizers left out, by this merge or an earlier one
  std::vector<Conflict> conflicts;
  std::vector<std::string> unreadable;  // sentences
};

// Associative, commutative and idempotent. An optimizer of which two folders measured different
// things is left out, and stays so: neither is chosen.
AuditUnion unite_audits(const std::vector<std::filesystem::path>& folders);

}  // namespace isoline::benchmarks
