// isoline compare BASE NEW: what is worse than before, and what is better.
#include <fmt/format.h>

#include <filesystem>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"
#include "reports/compare/gate.h"
#include "reports/page/page.h"
#include "reports/read/both_sides.h"

namespace isoline::benchmarks {

using reports::compare_results;
using reports::compare_sides;
using reports::comparison_page;
using reports::gate_json;
using reports::gate_markdown;
using reports::gate_section;
using reports::gate_terminal;
using reports::GateOptions;
using reports::GateResult;
using reports::kMostTimed;
using reports::read_allowed;
using reports::read_study;
using reports::Study;
using reports::study_of_both;

namespace {

namespace fs = std::filesystem;

// Said before anything is read.
void require_folders(const CompareArguments& given) {
  for (const std::string& side : {given.before, given.after})
    require(fs::is_directory(side), [&] {
      return fmt::format("--html compares the curves of two result folders, and {} is none", side);
    });
}

void write_page(const CompareArguments& given, const GateResult& result) {
  const Study both = study_of_both(read_study({given.before}, on_terminal("reading BASE")),
                                   read_study({given.after}, on_terminal("reading NEW")));
  const std::string headline = fmt::format("BASE: {} · NEW: {}", given.before, given.after);
  write_text(given.page, comparison_page(compare_sides(both), gate_section(result), headline));
  say(stderr, fmt::format("page: {}\n", given.page));
}

}  // namespace

int compare_verb(const CompareArguments& given, Session&) {
  if (!given.page.empty()) require_folders(given);
  require(given.timed.size() <= kMostTimed, [&] {
    return fmt::format("--time-cells takes at most {} cells, got {}", kMostTimed,
                       given.timed.size());
  });
  GateOptions options{.timed = given.timed, .is_common_only = given.is_common_only};
  if (given.tolerance >= 0) options.tolerance = given.tolerance;
  if (given.noise >= 0) options.least_noise = given.noise;
  if (!given.allowed.empty()) options.allowed = read_allowed(given.allowed);
  if (!given.trend.empty()) options.earlier = given.trend;
  options.listener = on_terminal("reading records");
  const GateResult result = compare_results(given.before, given.after, options);
  say(stdout, given.as_json       ? gate_json(result)
              : given.as_markdown ? gate_markdown(result)
                                  : gate_terminal(result, given.lists_all));
  if (!given.page.empty()) write_page(given, result);
  const bool is_fault = result.exit_code == kWorse || result.exit_code == kNotComparable;
  if (is_fault && (given.as_json || given.as_markdown))
    say(stderr, fmt::format("{}\n", result.verdict));  // the terminal's text begins with it
  return result.exit_code;
}

}  // namespace isoline::benchmarks
