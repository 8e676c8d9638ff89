// Turns the arguments of a command line into cells, and the cells into shards.
#include "benchmarks/cli/planned_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/cli/views.h"
#include "benchmarks/plan/rates.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/run_plan.h"
#include "benchmarks/shard/split.h"
#include "core/records/naming.h"
#include "core/spec.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

void override_blocks(const RunArguments& given, Suite& suite) {
  const std::uint64_t most_seeds = given.allow_large ? kMostWhereLarge : kMostSeeds;
  for (MatrixBlock& block : suite.blocks) {
    if (!given.seeds.empty())
      block.seeds = read_as("--seeds", [&] { return parse_seeds(given.seeds, most_seeds); });
    if (!given.instances.empty() || !given.starts.empty())
      block.seeds = read_as("--instances and --starts",
                            [&] { return crossed_seeds(given.instances, given.starts); });
    if (given.iterations > 0) block.budget.iterations = given.iterations;
    if (given.work > 0) block.budget.work = given.work;
    if (given.target >= 0) block.budget.target = given.target;
    if (given.seconds > 0) block.budget.seconds = given.seconds;
    if (given.stall >= 0)
      block.budget.stall =
          given.stall == kStallIterations ? std::nullopt : std::optional(given.stall);
    if (!given.stop.empty())
      block.budget.discrepancy = read_as("--stop", [&] { return discrepancy_of(given.stop); });
    if (given.threads > 0) block.threads = given.threads;
  }
}

// The suite with other optimizers, and other problems where these are given.
void put_instead(const RunArguments& given, Suite& suite) {
  if (!given.problem.empty()) suite.blocks.resize(1);
  for (MatrixBlock& block : suite.blocks) {
    block.optimizers = {given.instead};
    if (!given.problem.empty()) block.problems = {given.problem};
  }
}

void declare_cells(VerbArguments& verb, RunArguments& given) {
  verb.text(
      "SUITE", given.suite,
      "Name or path of a suite (default: quick); --problem and --optimizer select cells of it");
  verb.text("--problem", given.problem, "Problems: 'sine[xi=1|32,phi=45],square'").joined();
  const Argument optimizers =
      verb.text("--optimizer", given.optimizer, "Optimizers: 'adam[rate=1e-3],ceres-lm'").joined();
  verb.text("--instead", given.instead,
            "Optimizers to run instead of those of SUITE, on its problems with its seeds and "
            "budgets; --problem then names problems to use instead of those of SUITE")
      .joined()
      .excludes(optimizers);
  const Argument seeds =
      verb.text("--seeds", given.seeds,
                "Seeds: 5 (seeds 0 to 4), 0..9, =5 (seed 5), or 2:1 (instance 2, start 1)");
  verb.text("--instances", given.instances,
            "Instances (data) of each problem, each run from every start of --starts: 10, 0..9 or "
            "=5 (default: =0)")
      .excludes(seeds);
  verb.text("--starts", given.starts,
            "Starts, each used with every instance of --instances: 3, 0..2 or =1 (default: =0)")
      .excludes(seeds);
  verb.whole("--iterations", given.iterations, "Maximum number of iterations of a cell");
  verb.whole("--work", given.work, "Maximum work of a cell, in forward solves");
  verb.time("--time", given.seconds,
            "Time limit of a cell: 10s, 2m; a cell that uses twice this processor time is killed");
  verb.real(
      "--target", given.target, between(0, 1),
      "Tolerance at which a cell ends as solved, relative to the scale of the loss or, if the "
      "success criterion is x, to the norm of x* (default: 1e-10)");
  verb.whole_or_never(
      "--stall", given.stall,
      "Number of iterations without progress after which a cell ends (default: 100)");
  verb.text("--stop", given.stop,
            "Stopping rule instead of --target: discrepancy[tau=1.1] ends a cell at the first "
            "iterate with ‖y − y*‖ ≤ τδ, if the problem has noise of the level δ; or none");
  verb.text("--start", given.start,
            "Starting point of every problem: a .npy or .csv file of n numbers");
  verb.text("--target-data", given.target_data,
            "Observed data y* of every problem: a .npy or .csv file of m numbers");
  verb.whole("--threads", given.threads,
             "Number of threads that libraries use within a cell (default: 1)", kThreads);
  verb.text("--rates", given.rates, "Table of tuned rates: builtin, none or a file").shown();
  verb.text(
      "--best", given.best,
      "Table written by `isoline baseline --best`: the lowest known losses of problems that do not declare "
      "their least attainable loss f_L");
  verb.flag("--allow-large", given.allow_large, "Allow more than a million cells");
  verb.plugins();
}

void declare_what_is_done(VerbArguments& verb, RunArguments& given) {
  verb.text(
      "--out", given.out,
      "Result folder (default: results/SUITE; for your own study or a part of a suite, a name "
      "derived from the plan)");
  verb.flag("--force", given.force, "Run finished cells again");
  verb.flag(
      "--reuse", given.reuse,
      "Keep finished records that another build computed, instead of running their cells again");
  verb.texts("--retry", given.retry,
             "Run cells with these statuses again, such as failed,crashed,timeout,memory")
      .between_commas();
}

void declare_dry_run(VerbArguments& verb, RunArguments& given) {
  const Argument dry = verb.flag(
      "--dry-run", given.is_dry,
      "Run nothing: print the cells, their states and the predicted time, or, for the result folder "
      "of a run in place of SUITE, its progress");
  verb.whole("--shards", given.shards,
             "With --dry-run: divide the plan into this many shards of about equal time, and write "
             "the predictions to predicted.json in the result folder, unless that file exists",
             kShards)
      .needs(dry);
  verb.texts("--from", given.earlier,
             "With --dry-run: earlier result folders, from which times are predicted")
      .between_commas()
      .needs(dry);
  verb.flag("--all", given.lists_all, "With --dry-run: list every cell or shard, not the first 20")
      .needs(dry);
  verb.flag("--json", given.as_json, "With --dry-run: print JSON").needs(dry);
  verb.flag("--in-process", given.in_process,
            "Run the cells in this process, for a debugger: no isolation, no limits, no records")
      .excludes(dry);
}

}  // namespace

void declare_run(VerbArguments& verb, RunArguments& given) {
  declare_cells(verb, given);
  verb.whole("--jobs", given.jobs, "Number of cells at a time (default: one per core)", kJobs);
  verb.flag("--exclusive", given.exclusive, "Run one cell at a time, for reliable times");
  verb.text("--isolate", given.isolate,
            "cell: run each cell in a process of its own (default: cells of one problem run one "
            "after the other in a process, which a crash, a limit or a broken record replaces, and "
            "then they run again one by one)")
      .one_of({"cell"});
  verb.whole("--repeat", given.repeat, "Number of times that each cell is timed", {1, 1000});
  verb.memory("--memory", given.memory_bytes,
              "Memory limit of a cell, 256MB or more (default: 4GB)", 256);
  declare_what_is_done(verb, given);
  verb.flag("--no-report", given.no_report, "Do not write a report");
  declare_view(verb, given.view);
  verb.flag("--uncertified", given.uncertified,
            "Run problems from other programs without checking them first; each table marks these "
            "problems");
  verb.flag("--keep-output", given.keeps_output,
            "Keep the output of each cell in its record, up to 64 KiB");
  verb.flag("--log-evaluations", given.logs_evaluations,
            "Keep every call of problems from other programs in the store of evaluations, which "
            "answers later calls (default: calls that take 0.1 s or longer)");
  verb.flag(
      "--fields", given.keeps_fields,
      "For problems on a grid, keep x at six iterations for every seed (default: only for seed 0)");
  verb.flag("--spectrum", given.keeps_spectra,
            "Keep the singular values of J = ∂y/∂θ at iterations 0, 1, 2, 4, 8, … and the last; "
            "finished cells without them run again");
  verb.flag("--keep-state", given.keeps_states,
            "Keep the state of every cell that its budget ends, so that a larger --iterations or "
            "--work continues there (default: of cells that run for a minute or longer)");
  verb.text(
      "--shard", given.shard,
      "Run only one shard, such as 3/16; its records are written to shards/3-of-16 in the result "
      "folder. auto: take the shard from ISOLINE_SHARD or from the task of a scheduler's array");
  declare_dry_run(verb, given);
  verb.flag("--quiet", given.quiet, "Print only failures");
}

PlannedRun planned_run(const RunArguments& given, const Catalog& catalog) {
  if (!given.best.empty()) read_as("--best", [&] { BestLosses::add_known(given.best); });
  const bool is_limited = !given.problem.empty() || !given.optimizer.empty();
  const bool is_suite = !given.suite.empty() || !given.instead.empty() || !is_limited;
  Suite suite;
  if (is_suite) {
    require(builtin_suites().contains(given.suite) || !fs::is_directory(given.suite), [&] {
      return fmt::format(
          "{0} is a folder, not a suite; `isoline run {0} --dry-run` prints the progress of its run, "
          "and the command of the run continues it",
          given.suite);
    });
    suite = read_suite(given.suite.empty() ? "quick" : given.suite);
    if (!given.instead.empty()) put_instead(given, suite);
  } else {
    suite.name = "custom";
    suite.blocks = {{.problems = {given.problem.empty() ? "*" : given.problem},
                     .optimizers = {given.optimizer.empty() ? "*" : given.optimizer}}};
  }
  override_blocks(given, suite);
  if (!given.start.empty()) suite.problem_options.set(kStartOption, given.start);
  if (!given.target_data.empty()) suite.problem_options.set(kTargetOption, given.target_data);
  Rates rates = Rates::named(given.rates);
  const std::uint64_t most = given.allow_large ? kMostWhereLarge : kMostCells;
  const auto cells = [&] {
    const PlanSize size = size_of(catalog, suite);
    require(size.cells <= most, [&] {
      return too_large(size, most) + (given.allow_large ? "" : "; --allow-large lifts the limit");
    });
    return expand(catalog, suite, rates, most);
  };
  const bool is_of_file = is_suite && given.instead.empty() && fs::is_regular_file(given.suite);
  const bool is_part = is_suite && is_limited && given.instead.empty();
  PlannedRun all{is_part ? part_of_suite(suite.label()) : suite.label(),
                 is_of_file ? read_as(given.suite, cells) : cells(), given.out, std::move(rates)};
  if (is_part)
    all.requests = filtered(catalog, std::move(all.requests), given.problem, given.optimizer);
  if (!all.folder.empty()) return all;
  const std::string title = is_suite ? suite.name : "";
  const bool is_whole = !is_limited && given.instead.empty();
  all.folder = fs::path("results") / (!is_whole ? folder_name_of(all.requests, title) : title);
  return all;
}

void keep_shard(const std::string& text, PlannedRun& all) {
  const Shard shard = shard_of(text);
  const std::vector<double> weights = weights_of(all.requests, all.folder);
  const std::vector<std::size_t> shards = split(all.requests, weights, shard.count);
  all.requests = part_of(std::move(all.requests), shards, shard);
  all.folder = shard.folder(all.folder);
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

}  // namespace isoline::benchmarks
