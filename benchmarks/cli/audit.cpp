// isoline audit [OPTIMIZER...]: what its properties are, measured instead of asserted.
#include "benchmarks/audit/audit.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/verbs.h"
#include "core/json.h"
#include "reports/report.h"

namespace isoline::benchmarks {

using reports::properties_section;
using reports::terminal_section;
namespace {

struct AuditOptions {
  std::vector<std::string> names;
  std::string out;
  bool as_json = false;
};

void audit(const AuditOptions& options, Session& session) {
  const Catalog& catalog = session.catalog();
  for (const std::string& name : options.names) catalog.optimizers.at(name);  // or says which exist
  const std::vector<AuditedOptimizer> all =
      audit_all(catalog, options.names.empty() ? catalog.optimizers.names() : options.names);
  const Json json = audit_to_json(all);
  if (!options.out.empty()) {
    std::filesystem::create_directories(options.out);
    write_json(std::filesystem::path(options.out) / "audit.json", json);
  }
  if (options.as_json) {
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{}", terminal_section(properties_section(all)));
  }
  for (const AuditedOptimizer& audited : all)
    if (!audited.flags.empty()) session.exit_code = kWorse;
}

}  // namespace

void add_audit(CLI::App& app, Session& session) {
  const auto options = std::make_shared<AuditOptions>();
  CLI::App* verb = app.add_subcommand(
      "audit", "Measure optimizers' scaling, invariance, order, consistency and oracles");
  verb->add_option("OPTIMIZER", options->names, "Names of optimizers (default: all)");
  verb->add_option("--out", options->out, "Folder to write audit.json to, as reports read it");
  verb->add_flag("--json", options->as_json, "As JSON");
  verb->callback([options, &session] { audit(*options, session); });
}

}  // namespace isoline::benchmarks
