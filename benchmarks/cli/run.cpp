// isoline run: the whole matrix, then its report.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <thread>

#include "benchmarks/audit/audit.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/preview.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/sheets.h"
#include "benchmarks/run/soundness.h"
#include "core/json.h"
#include "core/spec.h"
#include "reports/report.h"

namespace isoline::benchmarks {

using reports::compare_optimizers;
using reports::Document;
using reports::document_of;
using reports::read_study;
using reports::Study;
using reports::terminal_table;
using reports::write_report;
namespace {

namespace fs = std::filesystem;

struct RunArguments {
  std::string suite, problem, optimizer, seeds, time, out, memory, rates = "builtin";
  std::int64_t iterations = 0, work = 0;
  double target = -1;
  int jobs = 0, threads = 0, repeat = 1;
  bool force = false, is_dry = false, exclusive = false, no_report = false, quiet = false;
};

std::int64_t parse_memory(const std::string& text) {
  const CLI::AsSizeValue to_bytes(false);
  std::string value = text;
  const std::string error = to_bytes(value);
  require(error.empty(),
          [&] { return fmt::format("expected an amount such as 2GB, got '{}'", text); });
  return std::stoll(value);
}

// The suite named, or the matrix of --problem and --optimizer; then what the options override.
Suite suite_of(const RunArguments& given) {
  Suite suite;
  if (given.problem.empty() && given.optimizer.empty()) {
    suite = read_suite(given.suite.empty() ? "quick" : given.suite);
  } else {
    require(given.suite.empty(), "give a suite or --problem and --optimizer, not both");
    suite.name = "custom";
    suite.blocks = {{.problems = {given.problem.empty() ? "*" : given.problem},
                     .optimizers = {given.optimizer.empty() ? "*" : given.optimizer}}};
  }
  for (MatrixBlock& block : suite.blocks) {
    if (!given.seeds.empty()) block.seeds = parse_seeds(given.seeds);
    if (given.iterations > 0) block.budget.iterations = given.iterations;
    if (given.work > 0) block.budget.work = given.work;
    if (given.target >= 0) block.budget.target = given.target;
    if (!given.time.empty()) block.budget.seconds = parse_duration(given.time);
    if (given.threads > 0) block.threads = given.threads;
  }
  return suite;
}

Rates rates_of(const std::string& given) {
  if (given == "builtin") return Rates::builtin();
  if (given == "none") return {};
  return Rates::from_json(read_json(given), given);
}

int jobs_of(const RunArguments& given) {
  if (given.jobs > 0) return given.jobs;
  return given.exclusive ? 1 : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

void print_plan(Session& session, const std::vector<Request>& requests, const fs::path& out,
                int jobs) {
  double seconds = 0;
  std::size_t cached = 0, inapplicable = 0;
  for (const PreviewedCell& cell : preview(session.catalog(), requests, out)) {
    const Request& request = *cell.request;
    std::string fate = "run";
    if (!cell.why_inapplicable.empty()) fate = "inapplicable: " + cell.why_inapplicable;
    if (cell.is_cached) fate = "cached";
    cached += cell.is_cached;
    inapplicable += !cell.is_cached && !cell.why_inapplicable.empty();
    seconds += cell.seconds;
    fmt::print("{:28} {:44} seed {:<4} {}\n", request.problem.spec, request.optimizer.spec,
               request.seed, fate);
  }
  fmt::print("{} cells: {} cached, {} inapplicable, {} to run, about {} with {} at a time\n",
             requests.size(), cached, inapplicable, requests.size() - cached - inapplicable,
             duration_text(seconds / jobs), jobs);
}

void print_outcome(const Outcome& outcome, bool quiet) {
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(kMost, outcome.failures.size()); ++i)
    fmt::print(stderr, "{}\n", outcome.failures[i]);
  if (outcome.failures.size() > kMost)
    fmt::print(stderr, "… and {} more\n", outcome.failures.size() - kMost);
  for (const std::string& name : outcome.conflicts)
    fmt::print(stderr, "{}: its repetition gave another result\n", name);
  if (outcome.reused_from_other_commits > 0)
    fmt::print(
        stderr,
        "{} of the reused cells were run by another commit or a changed tree; --force repeats "
        "them\n",
        outcome.reused_from_other_commits);
  if (quiet) return;
  std::vector<std::string> counts;
  for (const auto& [status, count] : outcome.statuses)
    counts.push_back(fmt::format("{} {}", count, name_of(status)));
  fmt::print("{} cells: {} run, {} reused ({})\n", outcome.planned, outcome.run, outcome.reused,
             fmt::join(counts, ", "));
}

// The properties at default options of all optimizers that ever ran in this folder.
std::vector<AuditedOptimizer> write_audit(const Catalog& catalog, const Study& study,
                                          const fs::path& out) {
  std::set<std::string> names;
  for (const Record& record : study.runs)
    if (const std::string& name = record.request.optimizer.name; catalog.optimizers.contains(name))
      names.insert(name);
  std::vector<AuditedOptimizer> all = audit_all(catalog, {names.begin(), names.end()});
  write_json(out / "audit.json", audit_to_json(all));
  return all;
}

void report_on(Session& session, const fs::path& out, bool quiet) {
  Study study = read_study({out});
  study.audits = write_audit(session.catalog(), study, out);
  const fs::path folder = out / "report";
  const Document document = document_of(compare_optimizers(study), covered_claims(session, study));
  write_report(document, folder);
  if (quiet) return;
  fmt::print("\n{}\nreport: {}\n", terminal_table(document), (folder / "index.html").string());
}

void run(const RunArguments& given, Session& session) {
  const Suite suite = suite_of(given);
  const std::vector<Request> requests = expand(session.catalog(), suite, rates_of(given.rates));
  const fs::path out = given.out.empty() ? fs::path("results") / suite.name : fs::path(given.out);
  RunOptions options{.jobs = jobs_of(given),
                     .force = given.force,
                     .exclusive = given.exclusive,
                     .repeat = given.repeat,
                     .command = session.command()};
  if (!given.memory.empty()) options.limits.memory_bytes = parse_memory(given.memory);
  if (!given.quiet) options.progress = Progress::style_of(STDERR_FILENO);
  require_sound(session.catalog(), requests);
  if (given.is_dry) return print_plan(session, requests, out, options.jobs);
  Store store(out);
  store.plan(suite.name, planned_cells(requests));
  write_sheets(session.catalog(), requests, store);
  const Outcome outcome = run_all(session.catalog(), requests, store, options);
  print_outcome(outcome, given.quiet);
  if (!given.no_report) report_on(session, out, given.quiet);
  if (outcome.is_interrupted) {
    fmt::print(stderr, "interrupted; the same command goes on where it stopped\n");
    session.exit_code = kInterrupted;
  } else if (!outcome.failures.empty() || !outcome.conflicts.empty()) {
    session.exit_code = kWorse;
  }
}

}  // namespace

void add_run(CLI::App& app, Session& session) {
  const auto given = std::make_shared<RunArguments>();
  CLI::App* verb = app.add_subcommand(
      "run", "Run a suite or a matrix of your own; what is done already is not repeated");
  verb->add_option("SUITE", given->suite, "Name of a suite, or path of one (default: quick)");
  verb->add_option("--problem", given->problem, "Problems: 'sine[xi=1|32,phi=45],square'");
  verb->add_option("--optimizer", given->optimizer, "Optimizers: 'adam[rate=1e-3],ceres-lm'");
  verb->add_option("--seeds", given->seeds, "5 (0 to 4), 0..9, or =5");
  verb->add_option("--iterations", given->iterations, "Most iterations of a cell")
      ->check(CLI::PositiveNumber);
  verb->add_option("--work", given->work, "Most work of a cell, in forward solves")
      ->check(CLI::PositiveNumber);
  verb->add_option("--time", given->time, "Most time of a cell: 10s, 2m; twice that kills it");
  verb->add_option("--target", given->target, "Stop at f_L + TARGET (f0 - f_L) (default: 1e-10)")
      ->check(CLI::Range(0.0, 1.0));
  verb->add_option("--threads", given->threads, "Threads of the libraries within a cell")
      ->check(CLI::Range(1, 256));
  verb->add_option("--jobs", given->jobs, "Cells at a time (default: one a core)")
      ->check(CLI::Range(1, 1024));
  verb->add_flag("--exclusive", given->exclusive, "One at a time, for tables of wall time");
  verb->add_option("--repeat", given->repeat, "Timings wanted of each cell")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--memory", given->memory, "Most memory of a cell (default: 4GB)");
  verb->add_option("--rates", given->rates, "Table of tuned rates: builtin, none or a file")
      ->capture_default_str();
  verb->add_option("--out", given->out, "Result folder (default: results/SUITE)");
  verb->add_flag("--force", given->force, "Repeat cells that are done");
  verb->add_flag("--dry-run", given->is_dry, "Print the plan: cells, cached, inapplicable, time");
  verb->add_flag("--no-report", given->no_report, "Leave the report out");
  verb->add_flag("--quiet", given->quiet, "Print failures only");
  verb->callback([given, &session] { run(*given, session); });
}

}  // namespace isoline::benchmarks
