// isoline check [SPEC]: are a problem's derivatives, adjoint, inverse and solution what they claim?
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/isolate.h"
#include "core/json.h"
#include "core/spec.h"
#include "problems/conformance.h"

namespace isoline::benchmarks {

using problems::examine;
using problems::Finding;
namespace {

constexpr double kCheckSeconds = 120;

struct CheckOptions {
  std::string spec;
  std::uint64_t seed = 0;
  bool as_json = false;
};

Json findings_of(const Catalog& catalog, const Component& component, std::uint64_t seed) {
  const Problem problem = make_problem(catalog, component, seed);
  RandomStream stream(seed, component.name, "check");
  Json all = Json::array();
  for (const Finding& finding : examine(problem, stream))
    all.push_back({{"property", finding.property},
                   {"figure", json_number(finding.figure)},
                   {"limit", json_number(finding.limit)},
                   {"reason", finding.reason},
                   {"holds", finding.holds()}});
  return all;
}

// The findings, from a process of its own: a broken problem costs its own check alone.
Json isolated_findings(const Catalog& catalog, const Component& component, std::uint64_t seed) {
  const auto text =
      isolated_text([&] { return findings_of(catalog, component, seed).dump(); }, kCheckSeconds);
  if (text) return parse_json(*text, component.spec);
  return Json::array({{{"property", "the problem can be made and examined"},
                       {"figure", "nan"},
                       {"limit", 0},
                       {"reason", "its process crashed, threw or took too long"},
                       {"holds", false}}});
}

std::vector<Component> chosen(const Catalog& catalog, const std::string& text) {
  std::vector<Component> components;
  if (text.empty()) {
    for (const std::string& name : catalog.problems.names())
      components.push_back(complete_problem(catalog, name, OptionValues()));
  } else {
    for (const Spec& spec : parse_specs(text))
      components.push_back(complete_problem(catalog, spec));
  }
  return components;
}

void print(const std::string& spec, const Json& findings) {
  fmt::print("{}\n", spec);
  for (const Json& finding : findings) {
    const bool holds = finding.at("holds").get<bool>();
    fmt::print("  {} {:66} {:9.2e} (at most {:.1e})\n", holds ? "pass" : "FAIL",
               finding.at("property").get<std::string>(), real_of(finding.at("figure")),
               real_of(finding.at("limit")));
    if (!holds) fmt::print("       {}\n", finding.at("reason").get<std::string>());
  }
}

void check(const CheckOptions& options, Session& session) {
  Json all = Json::object();
  std::size_t failed = 0, total = 0;
  for (const Component& component : chosen(session.catalog(), options.spec)) {
    all[component.spec] = isolated_findings(session.catalog(), component, options.seed);
    for (const Json& finding : all[component.spec]) failed += !finding.at("holds").get<bool>();
    total += all[component.spec].size();
    if (!options.as_json) print(component.spec, all[component.spec]);
  }
  if (options.as_json)
    fmt::print("{}\n", all.dump(2));
  else
    fmt::print("{} checks, {} failed\n", total, failed);
  if (failed > 0) session.exit_code = kWorse;
}

}  // namespace

void add_check(CLI::App& app, Session& session) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* verb = app.add_subcommand(
      "check", "Hold a problem's derivatives, adjoint and inverse to each other, with figures");
  verb->add_option("SPEC", options->spec, "Problems, as in `isoline run` (default: all)");
  verb->add_option("--seed", options->seed, "Seed of the instance and of the directions")
      ->capture_default_str();
  verb->add_flag("--json", options->as_json, "As JSON");
  verb->callback([options, &session] { check(*options, session); });
}

}  // namespace isoline::benchmarks
