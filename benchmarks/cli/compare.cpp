// isoline compare BASE NEW: what got worse, what got better.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "reports/compare/gate.h"

namespace isoline::benchmarks {

using reports::compare_results;
using reports::gate_json;
using reports::gate_markdown;
using reports::gate_terminal;
using reports::GateOptions;
using reports::GateResult;
using reports::kMostTimed;
namespace {

struct CompareArguments {
  std::string before, after;
  double tolerance = -1;
  GateOptions options;
  bool as_markdown = false, as_json = false;
};

void compare(const CompareArguments& given, Session& session) {
  GateOptions options = given.options;
  if (given.tolerance >= 0) options.tolerance = given.tolerance;
  options.listener = on_terminal("reading records");
  require(options.timed.size() <= kMostTimed, [&] {
    return fmt::format("--time-cells takes at most {} cells, got {}", kMostTimed,
                       options.timed.size());
  });
  const GateResult result = compare_results(given.before, given.after, options);
  const auto text = given.as_json ? gate_json : given.as_markdown ? gate_markdown : gate_terminal;
  fmt::print("{}", text(result));
  session.exit_code = result.exit_code;
}

}  // namespace

void add_compare(CLI::App& app, Session& session) {
  const auto given = std::make_shared<CompareArguments>();
  CLI::App* verb = app.add_subcommand("compare", "Tell what got worse between two results");
  verb->add_option("BASE", given->before, "Result folder, baseline, or a report.json")->required();
  verb->add_option("NEW", given->after, "Result folder, or a report.json")->required();
  verb->add_option("--tolerance", given->tolerance,
                   "Relative tolerance of figures (default: equal bit for bit)")
      ->check(CLI::Range(0.0, 1.0));
  verb->add_option("--time-cells", given->options.timed,
                   "Cells (digests, or their beginnings) whose time is judged, 20 at most")
      ->delimiter(',');
  verb->add_option("--noise", given->options.least_noise, "Least band of noise of times, relative")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  verb->add_flag("--common", given->options.is_common_only, "Let cells that only BASE has pass");
  CLI::Option* json = verb->add_flag("--json", given->as_json, "As JSON");
  verb->add_flag("--markdown", given->as_markdown, "As Markdown")->excludes(json);
  verb->footer(
      "Exit codes: 0 no worse and no better, 2 worse, 3 better only, 4 not comparable: another "
      "build\n"
      "or instruction set without --tolerance, or cells of BASE that NEW lacks without --common.\n"
      "Time is judged where both sides have 9 repetitions (run --repeat 9): Mann-Whitney with\n"
      "Benjamini-Hochberg at 0.05, and the whole 95 % interval of the ratio outside the noise "
      "that\n"
      "the repetitions show. Without --time-cells the 20 slowest such cells of BASE are judged.");
  verb->callback([given, &session] { compare(*given, session); });
}

}  // namespace isoline::benchmarks
