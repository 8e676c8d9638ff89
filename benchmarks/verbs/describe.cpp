// isoline describe NAME: describes a component in words; without a name, lists the components.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/sheets.h"
#include "core/json.h"
#include "core/options.h"
#include "core/spec.h"
#include "core/text.h"
#include "networks/network_entry.h"
#include "reports/report.h"

namespace isoline::benchmarks {

using networks::network_registry;
using networks::NetworkEntry;
namespace {

struct DescribeArguments {
  std::string name = "all";
  bool as_json = false, names_only = false;
};

const std::vector<std::string> kKinds = {"problems", "networks", "optimizers", "suites", "all"};

void declare(VerbArguments& verb, DescribeArguments& given) {
  verb.text(
          "NAME", given.name,
          "A component, by name or specification; or problems, networks, optimizers, suites or all, "
          "which are listed")
      .shown();
  verb.flag("--json", given.as_json, "Print JSON");
  verb.flag("--names", given.names_only, "Of a list, print names only, one per line");
  verb.plugins();
}

template <class Entry>
const std::string& name_to_give(const Entry& entry) {
  return entry.needs_argument.empty() ? entry.name : entry.needs_argument;
}

Json listing(Session& session, const std::string& kind) {
  Json all = Json::object();
  if (kind == "all" || kind == "problems")
    for (const auto& [name, entry] : session.catalog().problems)
      all["problems"].push_back(
          {{"name", name_to_give(entry)}, {"title", entry.title}, {"source", entry.source}});
  if (kind == "all" || kind == "networks")
    for (const auto& [name, entry] : network_registry())
      all["networks"].push_back({{"name", name}, {"title", entry.title}, {"source", entry.source}});
  if (kind == "all" || kind == "optimizers")
    for (const auto& [name, entry] : session.catalog().optimizers)
      all["optimizers"].push_back({{"name", name_to_give(entry)},
                                   {"title", entry.title},
                                   {"family", name_of(entry.family)},
                                   {"source", entry.source}});
  if (kind == "all" || kind == "suites")
    for (const auto& [name, text] : builtin_suites())
      all["suites"].push_back({{"name", name},
                               {"title", read_suite(name).title},
                               {"version", read_suite(name).version}});
  return all;
}

void print_list(const Json& all, bool names_only) {
  for (const auto& [kind, entries] : all.items()) {
    if (!names_only) say(stdout, fmt::format("{} {}\n", entries.size(), kind));
    for (const Json& entry : entries) {
      const auto name = entry.at("name").get<std::string>();
      if (names_only)
        say(stdout, fmt::format("{}\n", name));
      else
        say(stdout, fmt::format("  {:24} {}\n", name, entry.at("title").get<std::string>()));
    }
    if (!names_only) say(stdout, "\n");
  }
  if (!names_only) say(stdout, "`isoline describe NAME` shows the details.\n");
}

// The requested component in the catalog.
struct Described {
  Sheet sheet;
  OptionTable table;
  OptionValues options;  // the given values, and defaults for the others
};

// With the options that another program declares.
OptionTable options_of(OptionTable registered, const Component& component) {
  if (component.foreign)
    registered.insert(registered.end(), component.foreign->options.begin(),
                      component.foreign->options.end());
  return registered;
}

Described described_as_problem(const Catalog& catalog, const Spec& spec) {
  const Component problem = complete_problem(catalog, spec);
  return {problem_sheet(catalog, problem),
          options_of(catalog.problems.at(spec.name).options, problem), problem.options};
}

Described described_as_optimizer(const Catalog& catalog, const Spec& spec) {
  const Component optimizer = complete_optimizer(catalog, spec);
  return {optimizer_sheet(catalog, optimizer),
          options_of(catalog.optimizers.at(spec.name).options, optimizer), optimizer.options};
}

Described described(const Catalog& catalog, const Spec& spec) {
  const bool is_problem = catalog.problems.contains(spec.name);
  const bool is_optimizer = catalog.optimizers.contains(spec.name);
  if (is_problem && is_optimizer)
    try {  // an adapter has the same name for both roles; the external program states its role
      return described_as_optimizer(catalog, spec);
    } catch (const UsageError&) {
      return described_as_problem(catalog, spec);
    }
  if (is_problem) return described_as_problem(catalog, spec);
  if (is_optimizer) return described_as_optimizer(catalog, spec);
  std::vector<std::string> known = catalog.problems.names();
  for (const auto& names : {catalog.optimizers.names(), network_registry().names()})
    known.insert(known.end(), names.begin(), names.end());
  throw UsageError(unknown_name("problem, optimizer or network", spec.name, known));
}

std::string allowed_values(const OptionField& field) {
  if (!field.choices.empty()) {
    Choices named = field.choices;
    std::erase(named, "");  // an empty choice does not have a name
    return fmt::format("{}", fmt::join(named, "|"));
  }
  const bool is_number =
      std::holds_alternative<Real>(field.standard) || std::holds_alternative<Index>(field.standard);
  return is_number ? range_text(field.range) : "";
}

void print_options(const OptionTable& table, const OptionValues& values) {
  say(stdout, table.empty() ? "\nOptions     none\n" : "\nOptions\n");
  for (const OptionField& field : table) {
    const std::string value = option_text(values.at(field.name)),
                      standard = option_text(field.standard);
    say(stdout,
        fmt::format("  {:20} {:>12}  {:22} {}{}\n", field.name, value, allowed_values(field),
                    field.doc, value == standard ? "" : fmt::format(" (default: {})", standard)));
  }
}

void print(const NetworkEntry& network, const OptionValues& options, bool as_json) {
  if (as_json) {
    const Json json{{"kind", "network"},      {"name", network.name},
                    {"title", network.title}, {"source", network.source},
                    {"note", network.note},   {"options", describe_options(network.options)}};
    return say(stdout, fmt::format("{}\n", json_text(json, 2)));
  }
  say(stdout, fmt::format("{}: {} (network)\n\nSource      {}\n", network.name, network.title,
                          network.source));
  if (!network.note.empty()) say(stdout, fmt::format("Note        {}\n", network.note));
  print_options(network.options, options);
}

const char* aim_text(Aim aim) {
  return aim == Aim::x
             ? "x: the problem is solved if the error in x is small"
             : "loss: the problem is solved if the loss is small, whatever the error in x";
}

void print(const Sheet& sheet) {
  const bool is_problem = sheet.kind == "problem";
  say(stdout, fmt::format("{}: {} ({})\n\n  {}\n\nSource      {}\n", sheet.name, sheet.title,
                          sheet.kind, sheet.formula, sheet.source));
  if (!sheet.note.empty()) say(stdout, fmt::format("Note        {}\n", sheet.note));
  say(stdout, fmt::format("Family      {}{}\n", sheet.family, sheet.linear ? " (linear)" : ""));
  if (is_problem)
    say(stdout,
        fmt::format("Size        {} unknowns, {} residuals\nInverse     {}\nCriterion   {}\n",
                    sheet.unknowns, sheet.residuals, sheet.inverse,
                    aim_text(sheet.aim.value_or(Aim::loss))));
  say(stdout, fmt::format("{:11} {}\n", is_problem ? "Offers" : "Requires",
                          fmt::join(sheet.oracles, ", ")));
  if (!is_problem)
    say(stdout, fmt::format("Tuned by    {}\n", sheet.tunable.empty() ? "nothing" : sheet.tunable));
  if (!is_problem)
    say(stdout, fmt::format("Extra info  {}\n",
                            sheet.privileges.empty()
                                ? "none"
                                : fmt::format("{}", fmt::join(sheet.privileges, "; "))));
}

// Each rule that the measured conduct of the method, at its defaults, breaks, and the reason.
void print_conduct(const Sheet& sheet) {
  static const std::vector<AuditedOptimizer> all =
      audit_from_text(std::string(embedded_conduct()), "conduct.json");
  const auto found = std::ranges::find(all, sheet.name, &AuditedOptimizer::name);
  if (sheet.kind == "problem" || found == all.end()) return;
  const char* heading = "Conduct";
  for (const ConductCell& cell : found->conduct) {
    if (cell.holds.value_or(true)) continue;
    say(stdout, fmt::format("{:11} ✗ {}: {}. {} {}\n", heading, cell.column, cell.figures,
                            reports::conduct_text(cell.column, "reason"),
                            reports::conduct_text(cell.column, "advice")));
    heading = "";
  }
}

int list(const DescribeArguments& given, Session& session) {
  const Json all = listing(session, given.name);
  if (given.as_json)
    say(stdout, fmt::format("{}\n", json_text(all, 2)));
  else
    print_list(all, given.names_only);
  return kGood;
}

int run(const DescribeArguments& given, Session& session) {
  if (std::ranges::find(kKinds, given.name) != kKinds.end()) return list(given, session);
  const Spec spec = parse_spec(given.name);
  if (network_registry().contains(spec.name)) {
    const NetworkEntry& network = network_registry().at(spec.name);
    print(network, complete_options(network.options, spec.name, options_of(spec)), given.as_json);
    return kGood;
  }
  const Described found = described(session.catalog(), spec);
  if (given.as_json) {
    say(stdout, fmt::format("{}\n", json_text(to_json(found.sheet), 2)));
    return kGood;
  }
  print(found.sheet);
  if (found.sheet.kind == "optimizer")
    say(stdout, fmt::format("Bounds      {}\n",
                            session.catalog().optimizers.at(spec.name).keeps_bounds
                                ? "kept"
                                : "not kept: it does not run on problems that require them"));
  print_conduct(found.sheet);
  print_options(found.table, found.options);
  return kGood;
}

}  // namespace

void register_describe(VerbRegistry& registry) {
  registry.add(verb_of<DescribeArguments>(
      {.name = "describe",
       .help_position = 140,
       .summary =
           "Show the formula, options, required derivatives and source of a problem or method; list "
           "all of them",
       .examples = "  isoline describe\n  isoline describe optimizers --names\n"
                   "  isoline describe sip\n  isoline describe 'sine[xi=32]' --json"},
      declare, run));
}

}  // namespace isoline::benchmarks
