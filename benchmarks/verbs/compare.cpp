// isoline compare BASE NEW: lists what has become worse and better.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/left_out.h"
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
            "Relative tolerance of values (default: values must agree bit for bit)");
  verb.real("--noise", given.noise, between(0, 10),
            "Smallest relative difference of times that counts (default: 0.1)");
  verb.text("--allow", given.allowed,
            "File (isoline.allowed/1) of cells, with reasons, that NEW may lack or whose success "
            "criterion may differ");
  verb.flag("--common", given.is_common_only, "Allow NEW to lack any cell of BASE");
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
  if (std::error_code unknown; std::filesystem::is_regular_file(given.before, unknown))
    if (const Json json = read_json(given.before);
        json.is_object() && json.value("schema", Json()) == reports::kBaselineSchema)
      require_valid(json, "baseline", given.before);
  options.listener = progress_on_terminal("reading records");
  const reports::GateResult result = reports::compare_results(given.before, given.after, options);
  say_left_out(result.unreadable);
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
  registry.add(verb_of<CompareArguments>(
      {.name = "compare",
       .help_position = 40,
       .summary = "Compare two result folders and list regressions",
       .examples = R"(  isoline compare results/old results/new
  isoline compare baseline.json results/quick --tolerance 1e-6 --all
  isoline compare results/old results/new --markdown   for a job summary)",
       .notes =
           "A cell is one problem, one optimizer and one seed. Exit codes: 0 no differences; 2 "
           "regressions, or NEW lacks a cell of BASE; 3 improvements and no regressions; 4 not "
           "comparable. A cell is not comparable if a time limit ended it, if its record "
           "contradicts itself, if the success criterion, f_L, scale, floor or nominal costs "
           "differ, or if another build computed it and --tolerance is missing.\n"
           "Cells are paired by problem, optimizer, seed and budget as requested. If the default "
           "of an option has changed, the cells are still compared, and the change is printed.\n"
           "Times are compared for cells with 9 repetitions in both folders (run --repeat 9), "
           "for at most the 20 slowest cells of BASE. Two times count as different if a "
           "Mann-Whitney test rejects their equality at a false discovery rate of 0.05, and if "
           "the whole 95 % interval of their ratio lies outside the noise of the repetitions."},
      declare, run));
}

}  // namespace isoline::benchmarks
