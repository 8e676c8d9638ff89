// isoline check [SPEC]: checks a problem's derivatives, adjoint, inverse and solution.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/calls.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/process_group.h"
#include "core/differences.h"
#include "core/json.h"
#include "core/spec.h"
#include "core/text.h"
#include "problems/conformance.h"
#include "problems/differences.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using problems::examine;
using problems::Finding;
namespace {

struct CheckArguments {
  std::string spec;
  std::uint64_t seed = 0;
  bool as_json = false;
};

void declare(VerbArguments& verb, CheckArguments& given) {
  verb.text("SPEC", given.spec, "Problems, as in `isoline run` (default: all)");
  verb.seed("--seed", given.seed, "Seed of the instance and of the directions");
  verb.flag("--json", given.as_json, "Print JSON");
  verb.plugins();
}

constexpr double kCheckSeconds = 120;

// The noise of y in a call, and the steps of differences that follow from it; null where y is not
// finite.
Json noise_of(const Problem& problem) {
  constexpr Real kMost = 0.1;  // beyond, differences over the size of an unknown show noise alone
  const Real noise = problems::relative_noise(problem, problem.standard_start());
  if (!std::isfinite(noise)) return {};
  return {
      {"property",
       fmt::format("noise of y (relative steps of forward, central differences: {:.1e}, {:.1e})",
                   forward_step(noise), central_step(noise))},
      {"figure", json_number(noise)},
      {"limit", kMost},
      {"reason", "y changes from call to call, or with the last digits of x"},
      {"holds", noise <= kMost}};
}

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
  if (!problem.is_learned())
    if (const Json noise = noise_of(problem); !noise.is_null()) all.push_back(noise);
  return all;
}

// The findings, from a process of its own: a broken problem costs its own check alone. Null where
// the check was interrupted, which says nothing about the problem.
Json isolated_findings(const Catalog& catalog, const Component& component, std::uint64_t seed) {
  const auto [text, failure, is_interrupted] =
      isolated_text([&] { return json_text(findings_of(catalog, component, seed)); },
                    text_seconds_of(component, kCheckSeconds));
  if (text) return parse_json(*text, component.spec);
  if (is_interrupted || asked_to_end() != Asked::nothing) {
    say(stderr,
        fmt::format("isoline: the check of {} was interrupted: {}\n", component.spec, failure));
    return {};
  }
  return Json::array({{{"property", "the problem can be created and checked"},
                       {"figure", "nan"},
                       {"limit", 0},
                       {"reason", failure},
                       {"holds", false}}});
}

std::vector<Component> chosen(const Catalog& catalog, const std::string& text) {
  std::vector<Component> components;
  if (text.empty()) {
    for (const std::string& name : catalog.problems.ready().names())
      components.push_back(complete_problem(catalog, name, OptionValues()));
  } else {
    for (const Spec& spec : parse_specs(text))
      components.push_back(complete_problem(catalog, spec));
  }
  return components;
}

void print(const std::string& spec, const Json& findings) {
  say(stdout, fmt::format("{}\n", spec));
  for (const Json& finding : findings) {
    const bool holds = finding.at("holds").get<bool>();
    say(stdout, fmt::format("  {} {:66} {:9.2e} (at most {:.1e})\n", holds ? "pass" : "FAIL",
                            finding.at("property").get<std::string>(),
                            real_of(finding.at("figure")), real_of(finding.at("limit"))));
    if (!holds) say(stdout, fmt::format("       {}\n", finding.at("reason").get<std::string>()));
  }
}

int run(const CheckArguments& given, Session& session) {
  const InterruptGuard guard;
  Json all = Json::object();
  std::size_t failed = 0, total = 0;
  for (const Component& component : chosen(session.catalog(), given.spec)) {
    const Json findings = isolated_findings(session.catalog(), component, given.seed);
    if (findings.is_null()) return kInterrupted;
    for (const Json& finding : findings) failed += !finding.at("holds").get<bool>();
    total += findings.size();
    if (!given.as_json) print(component.spec, findings);
    if (!given.as_json && component.foreign && !component.foreign->note.empty())
      say(stdout, fmt::format("  note: {}\n", component.foreign->note));
    all[component.spec] = findings;
  }
  if (given.as_json)
    say(stdout, fmt::format("{}\n", json_text(all, 2)));
  else
    say(stdout, fmt::format("{}, {} failed\n", reports::counted(total, "check"), failed));
  return failed > 0 ? kWorse : kGood;
}

}  // namespace

void register_check(VerbRegistry& registry) {
  registry.add(verb_of<CheckArguments>(
      {.name = "check",
       .help_position = 160,
       .summary = "Check that a problem's derivatives, adjoint and inverse agree with each other",
       .examples = "  isoline check rosenbrock\n  isoline check 'poisson[N=8|16]' --seed 3"},
      declare, run));
}

}  // namespace isoline::benchmarks
