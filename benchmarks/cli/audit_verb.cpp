// isoline audit [OPTIMIZER...]: what its properties are, measured instead of asserted.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "benchmarks/audit/audit.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "core/text.h"
#include "reports/report.h"

namespace isoline::benchmarks {

using reports::kAllRows;
using reports::kFewRows;
using reports::properties_section;
using reports::terminal_section;

int audit_verb(const AuditArguments& given, Session& session) {
  const Catalog& catalog = session.catalog();
  for (const std::string& name : given.names) catalog.optimizers.at(name);  // or says which exist
  const std::vector<AuditedOptimizer> all =
      audit_all(catalog, given.names.empty() ? catalog.optimizers.ready().names() : given.names);
  if (!given.out.empty()) {
    std::filesystem::create_directories(given.out);
    write_audit(all, std::filesystem::path(given.out) / "audit.json");
  }
  say(stdout, given.as_json ? audit_text(all)
                            : terminal_section(properties_section(all),
                                               given.lists_all ? kAllRows : kFewRows));
  const bool has_flags = std::ranges::any_of(
      all, [](const AuditedOptimizer& audited) { return !audited.flags.empty(); });
  return has_flags ? kWorse : kGood;
}

}  // namespace isoline::benchmarks
