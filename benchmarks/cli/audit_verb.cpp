// isoline audit [OPTIMIZER...]: what its properties are, measured instead of asserted.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "benchmarks/audit/audit.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "core/json.h"
#include "reports/audit/audit.h"

namespace isoline::benchmarks {

using reports::audit_terminal;
using reports::AuditColumn;
using reports::kAuditColumns;
namespace {

void print_legend() {
  fmt::print(
      "At default options, but epsilon and cutoff 0 where they may be, as the names show. A pair "
      "of\nexponents is of the first step / of the loss change to first order.\n");
  for (const AuditColumn& column : kAuditColumns)
    fmt::print("  {}: {}\n", column.heading, column.meaning);
}

}  // namespace

int audit_verb(const AuditArguments& given, Session& session) {
  const Catalog& catalog = session.catalog();
  for (const std::string& name : given.names) catalog.optimizers.at(name);  // or says which exist
  const std::vector<AuditedOptimizer> all =
      audit_all(catalog, given.names.empty() ? catalog.optimizers.names() : given.names);
  const Json json = audit_to_json(all);
  if (!given.out.empty()) {
    std::filesystem::create_directories(given.out);
    write_json(std::filesystem::path(given.out) / "audit.json", json);
  }
  if (given.as_json) {
    fmt::print("{}\n", json_text(json, 2));
  } else {
    fmt::print("{}\n", audit_terminal(all));
    print_legend();
  }
  const bool has_flags = std::ranges::any_of(
      all, [](const AuditedOptimizer& audited) { return !audited.flags.empty(); });
  return has_flags ? kWorse : kGood;
}

}  // namespace isoline::benchmarks
