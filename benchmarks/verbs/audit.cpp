// isoline audit [OPTIMIZER...]: measures properties of optimizers.
#include "benchmarks/audit/audit.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "core/files.h"
#include "core/output.h"
#include "core/spec.h"
#include "core/text.h"
#include "reports/report.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct AuditArguments {
  std::vector<std::string> names;
  std::string out;
  bool measures_conduct = false, as_json = false, lists_all = false;
};

void declare(VerbArguments& verb, AuditArguments& given) {
  verb.texts("OPTIMIZER", given.names, "Names of optimizers (default: all)");
  verb.text("--out", given.out, "Folder for audit.json, which reports read");
  verb.flag("--conduct", given.measures_conduct,
            "Measure what counts, statuses, returned points and bounds mean, and print this table; "
            "its records go to FOLDER/conduct");
  verb.flag("--all", given.lists_all, "Print all lines of every table, not the first 20");
  verb.flag("--json", given.as_json, "Print JSON");
  verb.plugins();
}

int run(const AuditArguments& given, Session& session) {
  const Catalog& catalog = session.catalog();
  for (const std::string& name : given.names) {
    require(!catalog.problems.ready().contains(name), [&] {
      return fmt::format(
          "{0} is a problem, and audit measures optimizers; for a problem: isoline check {0}",
          name);
    });
    complete_optimizer(catalog, parse_spec(name));  // or says what is wrong
  }
  if (!given.out.empty()) make_output_folder(given.out);
  std::vector<AuditedOptimizer> all =
      audit_all(catalog, given.names.empty() ? catalog.optimizers.ready().names() : given.names);
  if (given.measures_conduct) {
    const HiddenFolder hidden;
    measure_conduct(catalog, all,
                    given.out.empty() ? hidden.path() : fs::path(given.out) / "conduct");
  }
  if (!given.out.empty()) write_audit(all, fs::path(given.out) / "audit.json");
  say(stdout, given.as_json
                  ? audit_text(all)
                  : reports::terminal_section(
                        given.measures_conduct ? reports::conduct_section(all)
                                               : reports::properties_section(all),
                        given.lists_all ? reports::kAllRows : reports::kFewRows, output_columns()));
  const bool has_flags = std::ranges::any_of(
      all, [](const AuditedOptimizer& audited) { return !audited.flags.empty(); });
  return has_flags ? kWorse : kGood;
}

}  // namespace

void register_audit(VerbRegistry& registry) {
  registry.add(verb_of<AuditArguments>(
      {.name = "audit",
       .help_position = 170,
       .summary =
           "Measure properties of optimizers: scaling, invariance, order, consistency and oracle "
           "calls",
       .examples = "  isoline audit gd adam sip\n  isoline audit --out results/quick --all\n"
                   "  isoline audit --conduct --out results/quick"},
      declare, run));
}

}  // namespace isoline::benchmarks
