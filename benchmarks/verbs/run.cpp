// isoline run: runs a suite or a study, and writes its report.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "benchmarks/audit/audit.h"
#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/cli/views.h"
#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/shard/split.h"
#include "core/seeds.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// The properties at default options of all optimizers that ever ran in this folder.
std::vector<AuditedOptimizer> audit_of(const Catalog& catalog, const reports::Study& study) {
  std::set<std::string> names;
  for (const Record& record : study.runs)
    if (const std::string& name = record.request.optimizer.name;
        catalog.optimizers.contains(name) && catalog.optimizers.at(name).needs_argument.empty())
      names.insert(name);
  return audit_all(catalog, {names.begin(), names.end()});
}

// The report of the folder, or only a view of it.
void report_on(const fs::path& out, const RunArguments& given, Session& session) {
  reports::Study study = reports::read_study({out});
  if (study.runs.empty()) return;  // interrupted before the first record
  if (given.no_report) return print_view(study, {.name = given.view});
  std::vector<AuditedOptimizer> before = std::move(study.audits);
  study.audits = audit_of(session.catalog(), study);
  for (AuditedOptimizer& audited : study.audits)  // `isoline audit --conduct` has measured it
    if (const auto known = std::ranges::find(before, audited.name, &AuditedOptimizer::name);
        known != before.end())
      audited.conduct = std::move(known->conduct);
  write_audit(study.audits, out / "audit.json");
  if (!given.quiet) say(stdout, "\n");
  write_and_print(study, out / "report", session, {.is_quiet = given.quiet || !given.view.empty()});
  if (!given.view.empty()) print_view(study, {.name = given.view});
}

// Without isolation and without records: what a debugger looks at.
int run_here(const Catalog& catalog, const std::vector<Request>& requests) {
  int code = kGood;
  run_in_process(catalog, requests, [&](const Request& request, const Trace& trace) {
    const std::string message = trace.message;
    const std::string reached = trace.status == Status::inapplicable
                                    ? ""
                                    : fmt::format(", after {} iterations, with loss {:.4g}",
                                                  trace.last.iteration, trace.last.loss);
    say(stdout, fmt::format("{}: status {}{}{}\n", title_of(request), name_of(trace.status),
                            reached, message.empty() ? "" : ": " + message));
    if (is_failure(trace.status)) code = kWorse;
  });
  say(stdout, "--in-process writes no records\n");
  return code;
}

int run(const RunArguments& given, Session& session) {
  if (given.is_dry) return dry_run(given, session);
  const Catalog& catalog = session.catalog();
  PlannedRun all = planned_run(given, catalog);
  const std::vector<PlannedCell> planned = planned_cells(all.requests);
  const fs::path whole = all.folder;
  if (!given.shard.empty()) keep_shard(given.shard, all);
  RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                     .force = given.force,
                     .uncertified = given.uncertified,
                     .reuse = given.reuse,
                     .retry = statuses_of(given.retry),
                     .exclusive = given.exclusive,
                     .isolates_cells = given.isolate == "cell",
                     .repeat = given.repeat,
                     .keeps_output = given.keeps_output,
                     .logs_calls = given.logs_evaluations,
                     .keeps_fields = given.keeps_fields,
                     .keeps_spectra = given.keeps_spectra,
                     .command = session.command()};
  if (given.exclusive) options.jobs = 1;
  if (given.keeps_states) options.least_kept_seconds = 0;
  if (given.memory_bytes > 0) options.limits.memory_bytes = given.memory_bytes;
  if (!given.quiet) options.progress = Progress::style_of(STDERR_FILENO);
  if (given.in_process) return run_here(catalog, all.requests);
  if (!given.shard.empty() && !given.force) adopt_records(all.requests, whole, all.folder);
  const Outcome outcome =
      run_plan(catalog, {all.name, planned, all.rates}, all.requests, all.folder, options);
  print_outcome(outcome, all.folder, given.quiet);
  const bool is_shown = !given.view.empty() && !outcome.is_interrupted;
  if ((!given.no_report || is_shown) && given.shard.empty()) report_on(all.folder, given, session);
  return exit_code_of(outcome);
}

}  // namespace

void register_run(VerbRegistry& registry) {
  registry.add(verb_of<RunArguments>(
      {.name = "run",
       .help_position = 10,
       .summary = "Run a suite or your own study; finished cells do not run again",
       .examples =
           R"(  isoline run                                the suite quick, then its report
  isoline run notebook --seeds 5 --jobs 4    another suite, on five seeds
  isoline run --problem 'sine[xi=1|32],heat' --optimizer 'adam[rate=1e-3]'
  isoline run quick --optimizer adam --dry-run     only print its cells
  isoline run results/quick --dry-run        the progress of a run
  isoline run quick --dry-run --shards 16    shards of about equal time
  isoline run quick --retry failed,crashed   failed cells again
  isoline run quick --shard 3/16             one shard, for `isoline merge`
  isoline run nist --instead 'process[command="./mine"],gd' --view digits
  isoline run --problem square --optimizer gd --seeds =3 --in-process   to debug)",
       .notes =
           "A cell is one problem, one optimizer and one seed, with a budget. Cells run in other "
           "processes, so a crash ends only its own cell (not with --in-process).\nRepeat "
           "the command to continue a run that was stopped.\n"
           "The predicted time of a cell is its time in records of the result folder and of --from "
           "or, without such a record, the time of the same cell with other seeds. Other cells "
           "have no prediction. --shard divides the plan by predicted.json alone, so all tasks use "
           "the same shards, whenever they start.\n"
           "Exit codes: 0 success, 2 cells failed or records disappeared, 130 interrupted."},
      declare_run, run));
}

}  // namespace isoline::benchmarks
