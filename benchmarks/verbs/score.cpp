// isoline score: an optimizer's correct digits on problems with a known solution, beside its peers.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/run_plan.h"
#include "core/results/published_digits.h"
#include "core/results/table.h"
#include "core/text.h"
#include "reports/formats/formats.h"

namespace isoline::benchmarks {
namespace {

std::string published_means() {
  std::string means;
  for (const auto& [name, mean] : results::kPublishedDigits)
    means += fmt::format("{}{} {:.1f}", means.empty() ? "" : ", ", name, mean);
  return fmt::format("Published mean LRE (header of nist.cc of Ceres): {}.\n", means);
}

constexpr const char* kMeaning =
    "LRE: the log relative error, about the number of correct digits of the least accurate "
    "parameter,\nfrom 0 to 11; forwards: the forward solves of all runs.\n";

struct ScoreArguments {
  std::string suite = "nist", problem, optimizer, out;
  std::string peers =
      "levenberg-marquardt,ceres-lm,ceres-tiny,minpack-lmder,gsl-multifit[trust-region=lm|lmaccel]";
  int jobs = 0;
};

void declare(VerbArguments& verb, ScoreArguments& given) {
  verb.text("SUITE", given.suite, "Suite whose problems, seeds and budgets are used").shown();
  verb.text("--problem", given.problem, "Problems to use instead of the problems of the suite")
      .joined();
  verb.text("--optimizer", given.optimizer, "Optimizers to score: 'process[command=\"…\"]'")
      .joined();
  verb.text(
      "--peers", given.peers,
      "Optimizers to compare with (default: Ceres, MINPACK, GSL and levenberg-marquardt); none: "
      "no comparison");
  verb.text("--out", given.out, "Result folder (default: results/SUITE-score)");
  verb.whole("--jobs", given.jobs, "Number of cells at a time (default: one per core)", kJobs);
  verb.plugins();
}

// The log relative errors of a method over its settings, at the points that it returned.
struct Score {
  std::string name;
  std::size_t runs = 0, solved = 0, precise = 0;
  Real digits = 0, calls = 0;  // their sums
};

Score score_of(const results::Table& table, std::size_t optimizer) {
  const results::OptimizerAxis& axis = table.optimizers[optimizer];
  Score score{.name = axis.label + results::marks_text(axis.marks())};
  for (const results::Run& run : table.runs) {
    const Record& record = *run.record;
    if (run.optimizer != optimizer || !record.x_scale || record.status == Status::inapplicable)
      continue;
    const Real lre = results::returned_digits(record);
    ++score.runs;
    score.solved += lre >= results::kSolvedDigits;
    score.precise += lre >= results::kAccurateDigits;
    score.digits += lre;
    score.calls += static_cast<Real>(record.counts[static_cast<std::size_t>(Oracle::forward)]);
  }
  score.digits /= static_cast<Real>(std::max<std::size_t>(score.runs, 1));
  return score;
}

void print_scores(const results::Table& table, const std::string& suite) {
  std::vector<Score> scores;
  for (std::size_t s = 0; s < table.optimizers.size(); ++s)
    if (Score score = score_of(table, s); score.runs > 0) scores.push_back(std::move(score));
  require(!scores.empty(),
          "no digits to count: none of these problems has a known solution. Declare its x, in a "
          "script as the argument truth of isoline.problem");
  std::ranges::stable_sort(scores, [](const Score& a, const Score& b) {
    return std::pair(a.solved, a.digits) > std::pair(b.solved, b.digits);
  });
  std::size_t width = 0;
  for (const Score& each : scores) width = std::max(width, each.name.size());
  say(stdout, fmt::format("{:{}}  LRE ≥ 4  LRE ≥ 6  mean LRE  forwards\n", "", width));
  for (const Score& each : scores)
    say(stdout,
        fmt::format("{:{}}  {:>7}  {:>7}  {:8.2f}  {:8.0f}\n", reports::terminal_text(each.name),
                    width, fmt::format("{}/{}", each.solved, each.runs),
                    fmt::format("{}/{}", each.precise, each.runs), each.digits, each.calls));
  if (suite == "nist") say(stdout, published_means());
  say(stdout, kMeaning);
}

int run(const ScoreArguments& given, Session& session) {
  Suite suite = read_suite(given.suite);
  for (MatrixBlock& block : suite.blocks) {
    block.optimizers.clear();
    for (const std::string& some : {given.optimizer, given.peers})
      if (!some.empty() && some != "none") block.optimizers.push_back(some);
    require(!block.optimizers.empty(), "nothing to score: pass --optimizer");
    if (!given.problem.empty()) block.problems = {given.problem};
  }
  if (!given.problem.empty()) suite.blocks.resize(1);
  const Rates rates = Rates::named("builtin");
  const std::filesystem::path folder =
      given.out.empty() ? "results/" + suite.name + "-score" : given.out;
  const std::vector<Request> requests = expand(session.catalog(), suite, rates);
  RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                     .command = session.command()};
  options.progress = Progress::style_of(STDERR_FILENO);
  const Outcome outcome =
      run_plan(session.catalog(), suite.label(), requests, folder, options, rates);
  print_outcome(outcome, folder, false);
  std::set<std::string> cells;
  for (const Request& request : requests) cells.insert(request.cell);
  results::Study study = results::read_study({folder.string()});
  std::erase_if(study.runs, [&](const Record& record) { return !cells.contains(record.cell); });
  if (!outcome.is_interrupted) print_scores(results::table_of(study), suite.name);
  return exit_code_of(outcome);
}

}  // namespace

void register_score(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "score",
       .help_position = 15,
       .summary =
           "Count the correct digits of an optimizer's results, and compare them with those of "
           "other optimizers",
       .examples = R"(  isoline score --optimizer 'process[command="python3 mine.py"]'
  isoline score --optimizer 'minpack-lmder[ftol=1e-8,xtol=1e-8]' --peers none)",
       .notes = "The default problems are NIST's regressions. Finished cells do not run again."},
      declare, run));
}

}  // namespace isoline::benchmarks
