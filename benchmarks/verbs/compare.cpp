// isoline compare BASE NEW: what is worse than before, and what is better.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/suite.h"
#include "core/json.h"
#include "core/text.h"
#include "reports/compare/gate.h"

namespace isoline::benchmarks {
namespace {

struct CompareArguments {
  std::string before, after;
  double tolerance = -1, noise = -1;  // −1: bit for bit; the standard band
  std::string allowed;                // a list of cells that NEW may lack, or may judge otherwise
  bool is_common_only = false, as_markdown = false, as_json = false, lists_all = false;
};

void declare(VerbArguments& verb, CompareArguments& given) {
  verb.text("BASE", given.before, "Result folder or baseline").required();
  verb.text("NEW", given.after, "Result folder").required();
  verb.real("--tolerance", given.tolerance, between(0, 1),
            "Relative tolerance of values (default: bit for bit)");
  verb.real("--noise", given.noise, between(0, 10),
            "Least band of noise of times, relative (default: 0.1)");
  verb.text(
      "--allow", given.allowed,
      "File that lists cells which NEW may lack, or may judge by another criterion of success "
      "(isoline.allowed/1), with reasons");
  verb.flag("--common", given.is_common_only, "Let NEW lack any cell of BASE");
  verb.flag("--all", given.lists_all, "List every difference, not the first 20 lines");
  const Argument json = verb.flag("--json", given.as_json, "Print JSON");
  verb.flag("--markdown", given.as_markdown, "Print Markdown").excludes(json);
}

int run(const CompareArguments& given, Session&) {
  reports::GateOptions options{.is_common_only = given.is_common_only};
  if (given.tolerance >= 0) options.tolerance = given.tolerance;
  if (given.noise >= 0) options.least_noise = given.noise;
  if (!given.allowed.empty()) {
    require_valid(read_json(given.allowed), "allowed", given.allowed);
    options.allowed = reports::read_allowed(given.allowed);
  }
  options.listener = progress_on_terminal("reading records");
  const reports::GateResult result = reports::compare_results(given.before, given.after, options);
  say(stdout, given.as_json       ? reports::gate_json(result)
              : given.as_markdown ? reports::gate_markdown(result)
                                  : reports::gate_terminal(result, given.lists_all));
  const bool is_fault = result.exit_code == kWorse || result.exit_code == kNotComparable;
  if (is_fault && (given.as_json || given.as_markdown))
    say(stderr, fmt::format("{}\n", result.verdict));  // the terminal's text begins with it
  return result.exit_code;
}

}  // namespace

void register_compare(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "compare",
       .help_position = 40,
       .summary = "Compare two results and list regressions",
       .examples = R"(  isoline compare results/old results/new
  isoline compare baseline.json results/quick --tolerance 1e-6 --all
  isoline compare results/old results/new --markdown     for the summary of a job)",
       .notes =
           "Exit codes: 0 no worse and no better; 2 worse, or NEW lacks a cell of BASE; 3 better only;\n"
           "4 not comparable: a clock ended a cell, its record contradicts itself, success is judged by\n"
           "another f_L, scale, floor, aim or cost, or it is of another build and --tolerance is not\n"
           "given. Cells are paired by what was asked of them, with seed and budget, so that a changed\n"
           "default is compared, and named.\n"
           "Time is judged where both sides have 9 repetitions (run --repeat 9): Mann-Whitney with\n"
           "Benjamini-Hochberg at 0.05, and the whole 95 % interval of the ratio outside the noise that\n"
           "the repetitions show. The 20 slowest such cells of BASE are judged."},
      declare, run));
}

}  // namespace isoline::benchmarks
