// isoline run: the whole matrix, then its report.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "benchmarks/audit/audit.h"
#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/reporting.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/filter.h"
#include "benchmarks/plan/plan_size.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/in_process.h"
#include "benchmarks/run/preview.h"
#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/soundness.h"
#include "core/spec.h"
#include "core/suggest.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;
using reports::read_study;
using reports::Study;
namespace {

namespace fs = std::filesystem;

// What is to be run, under which name, and where.
struct Undertaking {
  std::string name;
  std::vector<Request> requests;
  fs::path folder;
  Rates rates = {};
};

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

// A suite, whole or the part of it that --problem and --optimizer keep; or a matrix of these alone.
// Only a whole suite goes to the folder of its name: a part there would pass for the whole.
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

// --retry as statuses. What was interrupted is run again without it.
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

std::string fate_of(const PreviewedCell& cell) {
  if (cell.is_cached) return "cached";
  return cell.why_inapplicable.empty() ? "run" : "inapplicable: " + cell.why_inapplicable;
}

void print_plan(const Undertaking& all, const RunOptions& options, const RunArguments& given,
                Session& session) {
  constexpr std::size_t kMost = 20;
  const int jobs = options.jobs;
  const auto [cells, likened] =
      preview(session.catalog(), all.requests, all.folder,
              {.force = options.force, .reuse = options.reuse, .retry = options.retry});
  double seconds = 0;
  std::size_t cached = 0, inapplicable = 0;
  for (const PreviewedCell& cell : cells) {
    cached += cell.is_cached;
    inapplicable += !cell.is_cached && !cell.why_inapplicable.empty();
    seconds += cell.seconds;
  }
  say(stdout,
      fmt::format("{}: {} cached, {} inapplicable, {} to run, about {} with {} at a time\n",
                  counted(cells.size(), "cell"), cached, inapplicable,
                  cells.size() - cached - inapplicable, duration_text(seconds / jobs), jobs));
  if (likened > 0)
    say(stdout,
        fmt::format("{} of problems not probed: predicted like others of the same problem\n",
                    counted(likened, "setting")));
  say(stdout, fmt::format("result folder: {}\n", all.folder.string()));
  const std::size_t listed = given.lists_all ? cells.size() : std::min(kMost, cells.size());
  for (std::size_t i = 0; i < listed; ++i) {
    const Request& request = *cells[i].request;
    say(stdout, fmt::format("{:28} {:44} seed {:<4} {}\n", request.problem.spec,
                            request.optimizer.spec, request.seed, fate_of(cells[i])));
  }
  if (listed < cells.size())
    say(stdout, fmt::format("… and {} more; --all lists them\n", cells.size() - listed));
}

// The properties at default options of all optimizers that ever ran in this folder.
std::vector<AuditedOptimizer> audit_of(const Catalog& catalog, const Study& study) {
  std::set<std::string> names;
  for (const Record& record : study.runs)
    if (const std::string& name = record.request.optimizer.name; catalog.optimizers.contains(name))
      names.insert(name);
  return audit_all(catalog, {names.begin(), names.end()});
}

void report_on(const fs::path& out, bool quiet, Session& session) {
  Study study = read_study({out});
  if (study.runs.empty()) return;  // interrupted before the first record
  study.audits = audit_of(session.catalog(), study);
  write_audit(study.audits, out / "audit.json");
  if (!quiet) say(stdout, "\n");
  write_and_print(study, out / "report", session, quiet);
}

// Without isolation and without records: what a debugger looks at.
int run_here(const Catalog& catalog, const std::vector<Request>& requests) {
  int code = kGood;
  run_in_process(catalog, requests, [&](const Request& request, const Trace& trace) {
    const std::string message = trace.message;
    say(stdout, fmt::format("{}: {} at iteration {}, loss {:.4g}{}\n", title_of(request),
                            name_of(trace.status), trace.last.iteration, trace.last.loss,
                            message.empty() ? "" : ": " + message));
    if (is_failure(trace.status)) code = kWorse;
  });
  say(stdout, "--in-process: no record was written\n");
  return code;
}

}  // namespace

int run_verb(const RunArguments& given, Session& session) {
  const Catalog& catalog = session.catalog();
  const Undertaking all = undertaking_of(given, catalog);
  RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                     .force = given.force,
                     .reuse = given.reuse,
                     .retry = statuses_of(given.retry),
                     .exclusive = given.exclusive,
                     .repeat = given.repeat,
                     .keeps_output = given.keeps_output,
                     .keeps_fields = given.keeps_fields,
                     .keeps_spectra = given.keeps_spectra,
                     .command = session.command()};
  if (given.exclusive) options.jobs = 1;
  if (given.memory_bytes > 0) options.limits.memory_bytes = given.memory_bytes;
  if (!given.quiet) options.progress = Progress::style_of(STDERR_FILENO);
  if (given.is_dry) {
    require_sound(catalog, all.requests);
    print_plan(all, options, given, session);
    return kGood;
  }
  if (given.in_process) return run_here(catalog, all.requests);
  const Outcome outcome = run_plan(catalog, all.name, all.requests, all.folder, options, all.rates);
  print_outcome(outcome, all.folder, given.quiet);
  if (!given.no_report) report_on(all.folder, given.quiet, session);
  return exit_code_of(outcome);
}

}  // namespace isoline::benchmarks
