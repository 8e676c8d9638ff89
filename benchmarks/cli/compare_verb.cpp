// isoline compare BASE NEW: what is worse than before, and what is better.
#include <fmt/format.h>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/text.h"
#include "reports/compare/gate.h"

namespace isoline::benchmarks {

using reports::compare_results;
using reports::gate_json;
using reports::gate_markdown;
using reports::gate_terminal;
using reports::GateOptions;
using reports::GateResult;
using reports::kMostTimed;
using reports::read_allowed;

int compare_verb(const CompareArguments& given, Session&) {
  require(given.timed.size() <= kMostTimed, [&] {
    return fmt::format("--time-cells takes at most {} cells, got {}", kMostTimed,
                       given.timed.size());
  });
  GateOptions options{.timed = given.timed, .is_common_only = given.is_common_only};
  if (given.tolerance >= 0) options.tolerance = given.tolerance;
  if (given.noise >= 0) options.least_noise = given.noise;
  if (!given.allowed.empty()) options.allowed = read_allowed(given.allowed);
  options.listener = on_terminal("reading records");
  const GateResult result = compare_results(given.before, given.after, options);
  say(stdout, given.as_json       ? gate_json(result)
              : given.as_markdown ? gate_markdown(result)
                                  : gate_terminal(result, given.lists_all));
  const bool is_fault = result.exit_code == kWorse || result.exit_code == kNotComparable;
  if (is_fault && (given.as_json || given.as_markdown))
    say(stderr, fmt::format("{}\n", result.verdict));  // the terminal's text begins with it
  return result.exit_code;
}

}  // namespace isoline::benchmarks
