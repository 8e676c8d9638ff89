// The words of a command line, made cells.
#include "benchmarks/cli/undertaking.h"

#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/filter.h"
#include "benchmarks/plan/plan_size.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/run_plan.h"
#include "core/spec.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;
namespace {

namespace fs = std::filesystem;

void override_blocks(const RunArguments& given, Suite& suite) {
  const std::uint64_t most_seeds = given.allow_large ? kMostWhereLarge : kMostSeeds;
  for (MatrixBlock& block : suite.blocks) {
    if (!given.seeds.empty()) block.seeds = parse_seeds(given.seeds, most_seeds);
    if (given.iterations > 0) block.budget.iterations = given.iterations;
    if (given.work > 0) block.budget.work = given.work;
    if (given.target >= 0) block.budget.target = given.target;
    if (given.seconds > 0) block.budget.seconds = given.seconds;
    if (given.threads > 0) block.threads = given.threads;
  }
}

}  // namespace

Undertaking undertaking_of(const RunArguments& given, const Catalog& catalog) {
  const bool is_limited = !given.problem.empty() || !given.optimizer.empty();
  const bool is_suite = !given.suite.empty() || !is_limited;
  Suite suite;
  if (is_suite) {
    suite = read_suite(given.suite.empty() ? "quick" : given.suite);
  } else {
    suite.name = "custom";
    suite.blocks = {{.problems = {given.problem.empty() ? "*" : given.problem},
                     .optimizers = {given.optimizer.empty() ? "*" : given.optimizer}}};
  }
  override_blocks(given, suite);
  Rates rates = Rates::named(given.rates);
  const std::uint64_t most = given.allow_large ? kMostWhereLarge : kMostCells;
  const PlanSize size = size_of(catalog, suite);
  require(size.cells <= most, [&] {
    return too_large(size, most) + (given.allow_large ? "" : "; --allow-large lifts the limit");
  });
  Undertaking all{suite.name, expand(catalog, suite, rates, most), given.out, std::move(rates)};
  if (is_suite && is_limited)
    all.requests = filtered(catalog, std::move(all.requests), given.problem, given.optimizer);
  if (!all.folder.empty()) return all;
  const std::string title = is_suite ? suite.name : "";
  all.folder = fs::path("results") / (is_limited ? folder_name_of(all.requests, title) : title);
  return all;
}

std::set<Status> statuses_of(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const std::string_view name : kStatusNames)
    if (name != name_of(Status::running)) known.emplace_back(name);
  std::set<Status> statuses;
  for (const std::string& name : names) {
    require(std::ranges::find(known, name) != known.end(),
            [&] { return "--retry: " + unknown_name("status", name, known); });
    statuses.insert(*status_of(name));
  }
  return statuses;
}

std::string words_of(const PreviewCounts& counts, int jobs) {
  return fmt::format("{}: {} cached, {} inapplicable, {} to run, about {} with {} at a time",
                     counted(counts.cells, "cell"), counts.cached, counts.inapplicable,
                     counts.missing, duration_text(counts.seconds / jobs), jobs);
}

void print_counts(const Preview& shown, int jobs) {
  say(stdout, words_of(counts_of(shown.cells), jobs) + "\n");
  if (shown.likened > 0)
    say(stdout,
        fmt::format("{} of problems not probed: predicted like others of the same problem\n",
                    counted(shown.likened, "setting")));
}

}  // namespace isoline::benchmarks
