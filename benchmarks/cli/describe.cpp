// isoline describe NAME: what a component is, in words.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/sheets.h"
#include "core/json.h"
#include "core/option_json.h"
#include "core/spec.h"
#include "networks/network.h"

namespace isoline::benchmarks {

using networks::network_registry;
using networks::NetworkEntry;
namespace {

Sheet sheet_of(Session& session, const Spec& spec) {
  const Catalog& catalog = session.catalog();
  if (catalog.problems.contains(spec.name))
    return problem_sheet(catalog, complete_problem(catalog, spec));
  if (catalog.optimizers.contains(spec.name))
    return optimizer_sheet(catalog, complete_optimizer(catalog, spec));
  std::vector<std::string> known = catalog.problems.names();
  for (const auto& names : {catalog.optimizers.names(), network_registry().names()})
    known.insert(known.end(), names.begin(), names.end());
  throw UsageError(unknown_name("component", spec.name, known));
}

void print_options(const Json& options) {
  if (options.empty())
    fmt::print("\nIt has no options.\n");
  else
    fmt::print("\nOptions\n");
  for (const Json& option : options) {
    std::string law;
    if (option.contains("range")) law = option["range"].get<std::string>();
    if (option.contains("choices"))
      law = fmt::format("{}", fmt::join(option["choices"].get<std::vector<std::string>>(), "|"));
    const Json& standard = option.at("default");
    fmt::print("  {:20} {:>12}  {:22} {}\n", option.at("name").get<std::string>(),
               standard.is_string() ? standard.get<std::string>() : standard.dump(), law,
               option.at("doc").get<std::string>());
  }
}

void print(const NetworkEntry& network, bool as_json) {
  const Json options = describe_options(network.options);
  if (as_json) {
    const Json json{{"kind", "network"},        {"name", network.name}, {"title", network.title},
                    {"source", network.source}, {"note", network.note}, {"options", options}};
    return fmt::print("{}\n", json.dump(2));
  }
  fmt::print("{}: {} (network)\n\nSource      {}\n", network.name, network.title, network.source);
  if (!network.note.empty()) fmt::print("Note        {}\n", network.note);
  print_options(options);
}

void print(const Sheet& sheet) {
  const bool is_problem = sheet.kind == "problem";
  fmt::print("{}: {} ({})\n\n  {}\n\nSource      {}\n", sheet.name, sheet.title, sheet.kind,
             sheet.formula, sheet.source);
  if (!sheet.note.empty()) fmt::print("Note        {}\n", sheet.note);
  if (is_problem)
    fmt::print("Size        {} unknowns, {} residuals\nInverse     {}\n", sheet.unknowns,
               sheet.residuals, sheet.inverse);
  else
    fmt::print("Family      {}\n", sheet.family);
  fmt::print("{:11} {}\n", is_problem ? "Offers" : "Needs", fmt::join(sheet.oracles, ", "));
  if (!is_problem)
    fmt::print("Privileges  {}\n", sheet.privileges.empty()
                                       ? "none"
                                       : fmt::format("{}", fmt::join(sheet.privileges, "; ")));
  print_options(parse_json(sheet.options_text, "options"));
}

}  // namespace

void add_describe(CLI::App& app, Session& session) {
  struct Options {
    std::string name;
    bool as_json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "describe", "Tell the formula, options, needs and source of a problem, network or optimizer");
  verb->add_option("NAME", options->name, "A name of `isoline list`, or a spec")->required();
  verb->add_flag("--json", options->as_json, "As JSON");
  verb->callback([options, &session] {
    const Spec spec = parse_spec(options->name);
    if (network_registry().contains(spec.name))
      return print(network_registry().at(spec.name), options->as_json);
    const Sheet sheet = sheet_of(session, spec);
    if (options->as_json)
      fmt::print("{}\n", to_json(sheet).dump(2));
    else
      print(sheet);
  });
}

}  // namespace isoline::benchmarks
