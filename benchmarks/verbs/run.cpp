// isoline run: runs a suite or a study, and writes its report.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "benchmarks/audit/audit.h"
#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/shard/split.h"
#include "core/seeds.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

std::string fate_of(const PreviewedCell& cell) {
  if (cell.is_cached) return "cached";
  return cell.why_inapplicable.empty() ? "run" : "inapplicable: " + cell.why_inapplicable;
}

void print_plan(const PlannedRun& all, int jobs, const RunArguments& given, Session& session) {
  constexpr std::size_t kMost = 20;
  const Preview shown = preview_of(all, given, {}, {all.folder}, session);
  const std::vector<PreviewedCell>& cells = shown.cells;
  print_counts(shown, jobs);
  say(stdout, fmt::format("result folder: {}\n", all.folder.string()));
  const std::size_t listed = given.lists_all ? cells.size() : std::min(kMost, cells.size());
  for (std::size_t i = 0; i < listed; ++i) {
    const Request& request = *cells[i].request;
    say(stdout, fmt::format("{:28} {:44} seed {:<4} {}\n", request.problem.spec,
                            request.optimizer.spec, seed_text(request.seed), fate_of(cells[i])));
  }
  if (listed < cells.size())
    say(stdout, fmt::format("… and {} more cell{}; --all lists them\n", cells.size() - listed,
                            cells.size() - listed == 1 ? "" : "s"));
}

// One shard of the run alone, in a folder of its own. The plan that is stored there stays
// whole: a part never passes for it.
void keep_shard(const Shard& shard, PlannedRun& all) {
  const std::vector<double> weights = weights_of(all.requests, all.folder);
  const std::vector<std::size_t> shards = split(all.requests, weights, shard.count);
  all.requests = part_of(std::move(all.requests), shards, shard);
  all.folder = shard.folder(all.folder);
}

// The properties at default options of all optimizers that ever ran in this folder.
std::vector<AuditedOptimizer> audit_of(const Catalog& catalog, const reports::Study& study) {
  std::set<std::string> names;
  for (const Record& record : study.runs)
    if (const std::string& name = record.request.optimizer.name;
        catalog.optimizers.contains(name) && catalog.optimizers.at(name).needs_argument.empty())
      names.insert(name);
  return audit_all(catalog, {names.begin(), names.end()});
}

void report_on(const fs::path& out, bool quiet, Session& session) {
  reports::Study study = reports::read_study({out});
  if (study.runs.empty()) return;  // interrupted before the first record
  study.audits = audit_of(session.catalog(), study);
  write_audit(study.audits, out / "audit.json");
  if (!quiet) say(stdout, "\n");
  write_and_print(study, out / "report", session, {.is_quiet = quiet});
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
  const Catalog& catalog = session.catalog();
  PlannedRun all = planned_run(given, catalog);
  const std::vector<PlannedCell> planned = planned_cells(all.requests);
  const fs::path whole = all.folder;
  if (!given.shard.empty()) keep_shard(shard_of(given.shard), all);
  RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                     .force = given.force,
                     .uncertified = given.uncertified,
                     .reuse = given.reuse,
                     .retry = statuses_of(given.retry),
                     .exclusive = given.exclusive,
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
  if (given.is_dry) {
    print_plan(all, options.jobs, given, session);
    return kGood;
  }
  if (given.in_process) return run_here(catalog, all.requests);
  if (!given.shard.empty() && !given.force) adopt_records(all.requests, whole, all.folder);
  const Outcome outcome =
      run_plan(catalog, {all.name, planned, all.rates}, all.requests, all.folder, options);
  print_outcome(outcome, all.folder, given.quiet);
  if (!given.no_report && given.shard.empty()) report_on(all.folder, given.quiet, session);
  return exit_code_of(outcome);
}

}  // namespace

void register_run(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "run",
       .help_position = 10,
       .summary = "Run a suite or your own study; finished cells do not run again",
       .examples =
           R"(  isoline run                                the suite quick, then its report
  isoline run notebook --seeds 5 --jobs 4    another suite, on five seeds
  isoline run --problem 'sine[xi=1|32],heat' --optimizer 'adam[rate=1e-3]'
  isoline run quick --optimizer adam --dry-run     only print its cells
  isoline run quick --retry failed,crashed   failed cells again
  isoline run quick --shard 3/16             one shard, for `isoline merge`
  isoline run --problem square --optimizer gd --seeds =3 --in-process   to debug)",
       .notes =
           "A cell is one problem, one optimizer and one seed, with a budget. Each cell runs in "
           "its own process, so a crash ends only its own cell (not with --in-process).\nRepeat "
           "the command to continue a run that was stopped.\n"
           "Exit codes: 0 success, 2 cells failed or records disappeared, 130 interrupted."},
      declare_run, run));
}

}  // namespace isoline::benchmarks
