// The table of conduct of methods as Isoline runs them: one function for each column, of the
// records of the problem `conduct`. docs/conduct.md has the same columns for libraries without
// Isoline.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "benchmarks/audit/audit.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/store.h"
#include "core/decompose.h"
#include "core/errors.h"
#include "core/spec.h"
#include "problems/problem.h"

namespace isoline::benchmarks {
namespace {

constexpr std::int64_t kBudget = 10;
constexpr const char *kOnTwoThreads = "E3 on two threads", *kShort = "RB in 10";

struct Cell {
  std::optional<bool> holds;
  std::string figures;
};

// Why a column has no figures.
struct NotRun {
  Cell cell;
};

// The records of a method, which note those that a column asks for.
class Runs {
 public:
  Runs(const Catalog& catalog, const std::map<std::string, Record>& records)
      : catalog_(catalog), records_(records) {}

  const Record& of(const std::string& name) {
    const auto found = records_.find(name);
    if (found == records_.end()) throw NotRun{{std::nullopt, "not run"}};
    const Record& record = found->second;
    const std::string file = record.file_name();
    if (std::ranges::find(used, file) == used.end()) used.push_back(file);
    if (record.status == Status::inapplicable) throw NotRun{{std::nullopt, record.message}};
    if (is_failure(record.status))
      throw NotRun{
          {false, fmt::format("{} on {}: {}", name_of(record.status), name, record.message)}};
    return record;
  }
  bool has_ended(const std::string& name) const {
    const auto found = records_.find(name);
    return found != records_.end() && found->second.status != Status::inapplicable &&
           !is_failure(found->second.status);
  }
  const Catalog& catalog() const { return catalog_; }

  std::vector<std::string> used;

 private:
  const Catalog& catalog_;
  const std::map<std::string, Record>& records_;
};

std::int64_t forwards(const Record& record) {
  return record.counts[static_cast<std::size_t>(Oracle::forward)];
}
// A quantity of the problem at the end of the run.
Real last(const Record& record, const char* series) { return record.series.at(series).back(); }
std::int64_t calls(const Record& record) {
  return static_cast<std::int64_t>(last(record, "calls"));
}
Vector returned(const Record& record) {
  if (record.answer && !record.answer->point(kReturned).empty()) {
    const std::span<const Real> x = record.answer->point(kReturned);
    return Eigen::Map<const Vector>(x.data(), static_cast<Index>(x.size()));
  }
  return {};
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

Cell own_counter(Runs& runs) {
  const Record& run = runs.of("E3");
  return {forwards(run) == calls(run), fmt::format("{} of {}", forwards(run), calls(run))};
}

Cell beyond_budget(Runs& runs) {
  const Record& run = runs.of(kShort);
  const std::int64_t beyond = std::max<std::int64_t>(run.summary.work, calls(run)) - kBudget;
  return {beyond <= 0, fmt::format("{}", std::max<std::int64_t>(0, beyond))};
}

Cell returned_point(Runs& runs) {
  std::vector<std::string> words;
  for (const char* name : {"RB", kShort}) {
    const Record& run = runs.of(name);
    const Real above = run.summary.loss - run.summary.best_loss;
    words.push_back(above <= 0 ? "best" : fmt::format("{:.1g} above the best", above));
  }
  return {words[0] == "best" && words[1] == "best", fmt::format("{}; {}", words[0], words[1])};
}

Cell started_at_solution(Runs& runs) {
  const Record& run = runs.of("QD");
  std::int64_t all = 0;
  for (const std::int64_t count : run.counts) all += count;
  const bool has_derivatives = all > forwards(run);
  const std::int64_t n = 3, most = has_derivatives ? n + 2 : 2 * n + 10;
  return {run.status == Status::converged && forwards(run) <= most,
          fmt::format("{}, {} call{}", name_of(run.status), forwards(run),
                      forwards(run) == 1 ? "" : "s")};
}

Cell trial_without_value(Runs& runs) {
  const Record& run = runs.of("missing");
  const Vector x = returned(run);
  const std::string words =
      fmt::format("{}, x = {:.4g}", name_of(run.status), x.size() > 0 ? x[0] : std::nan(""));
  if (!run.failures) return {std::nullopt, "none met; " + words};
  return {std::isfinite(run.summary.loss) && x.size() > 0,
          fmt::format("{} of {}; {}", run.failures->total, calls(run), words)};
}

// Whether the step of Gauss-Newton is below 1e-6 of each unknown that no bound holds to 1e-6.
bool is_solved(const Catalog& catalog, const Record& run) {
  constexpr Real kSmall = 1e-6;
  const Problem problem = make_problem(catalog, run.request.problem, 0);
  const Vector x = returned(run);
  if (x.size() != problem.unknowns()) return false;
  Point at;
  Matrix J;
  problem.forward(x, at);
  problem.jacobian(J, at);
  Vector r(problem.residuals()), step;
  problem.residual(at, r);
  if (!J.allFinite() || !r.allFinite()) return false;
  const Vector slope = J.transpose() * r, size = x.cwiseAbs().cwiseMax(kSmall);
  std::vector<Index> free;
  for (Index i = 0; i < x.size(); ++i) {
    const problems::Bounds* const b = problem.bounds();
    const bool is_held = b && ((x[i] <= b->lower[i] + kSmall * size[i] && slope[i] > 0) ||
                               (x[i] >= b->upper[i] - kSmall * size[i] && slope[i] < 0));
    if (!is_held) free.push_back(i);
  }
  if (free.empty()) return true;
  if (!least_squares(J(Eigen::all, free), -r, 0, step)) return false;
  return (step.cwiseAbs().array() <= kSmall * size(free).array()).all();
}

Cell claims_success(Runs& runs) {
  std::vector<std::string> wrong, refused;
  int claims = 0;
  for (const char* name : {"line", "E3", "E3s", "RB", "RBb", "missing"}) {
    if (!runs.has_ended(name)) continue;
    const Record& run = runs.of(name);
    if (run.status == Status::unconfirmed) refused.emplace_back(name);
    if (run.status != Status::converged) continue;
    ++claims;
    if (!is_solved(runs.catalog(), run)) wrong.emplace_back(name);
  }
  std::string words = fmt::format("{} converged", claims);
  if (!refused.empty()) words += fmt::format(", unconfirmed: {}", listed(refused));
  if (!wrong.empty()) words += fmt::format(", not so on {}", listed(wrong));
  return {wrong.empty(), words};
}

Cell outside_bounds(Runs& runs) {
  const Record& run = runs.of("RBb");
  const Real count = last(run, "outside");
  const std::string words = fmt::format("{} of {}", count, calls(run));
  if (count == 0) return {true, words};
  return {false, fmt::format("{}, by up to {:.2g}", words, last(run, "farthest outside"))};
}

Cell scales(Runs& runs) {
  const Record& plain = runs.of("E3");
  const Vector x = returned(plain);
  std::vector<std::string> words;
  bool is_same = true;
  for (const char* name : {"E3s", "E3 small"}) {
    const Record& run = runs.of(name);
    Vector other = returned(run);
    if (std::string_view(name) == "E3s" && other.size() > 1) other[1] *= 1e-6;
    const Real off = x.size() == other.size() && x.size() > 0
                         ? (other - x).cwiseAbs().cwiseQuotient(x.cwiseAbs()).maxCoeff()
                         : std::nan("");
    is_same =
        is_same && off <= 1e-6 && 10 * std::abs(forwards(run) - forwards(plain)) <= forwards(plain);
    words.push_back(
        fmt::format("x off by {:.1g}, {} for {} calls", off, forwards(run), forwards(plain)));
  }
  return {is_same, fmt::format("{}; {}", words[0], words[1])};
}

Cell loose_bound(Runs& runs) {
  const Record &within = runs.of("E3 within"), &plain = runs.of("E3");
  return {10 * within.summary.work <= 11 * plain.summary.work,
          fmt::format("{} for {}", within.summary.work, plain.summary.work)};
}

// Two runs in a process of their own, against the record.
Cell second_run(Runs& runs) {
  constexpr double kSeconds = 60;
  const Record& run = runs.of("E3");
  Record on_threads = runs.of(kOnTwoThreads);
  const auto [first, failure, is_interrupted] = isolated_text(
      [&] {
        std::string difference;
        for (int i = 0; i < 2; ++i) {
          const auto trace = std::make_unique<Trace>();  // large
          execute(runs.catalog(), run.request, *trace);
          const std::string here = compare_results(run, record_of(run.request, *trace)).difference;
          if (difference.empty()) difference = here;
        }
        return difference;
      },
      kSeconds);
  if (!first) return {false, "second run: " + failure};
  on_threads.cell = run.cell;
  on_threads.request = run.request;
  const std::string threads = compare_results(run, on_threads).difference;
  return {first->empty() && threads.empty(),
          fmt::format("second run {}; threads {}", first->empty() ? "same" : *first,
                      threads.empty() ? "same" : threads)};
}

Cell text_printed(Runs& runs) {
  const Record& run = runs.of("E3");
  return {run.output.empty(), fmt::format("{} bytes", run.output.size())};
}

struct Column {
  const char* name;
  Cell (*measure)(Runs& runs);
};
constexpr Column kColumns[] = {{"own counter", own_counter},
                               {"beyond a budget", beyond_budget},
                               {"returned point", returned_point},
                               {"started at the solution", started_at_solution},
                               {"trial without a value", trial_without_value},
                               {"claims success", claims_success},
                               {"outside the bounds", outside_bounds},
                               {"scales", scales},
                               {"loose bound", loose_bound},
                               {"second run", second_run},
                               {"text", text_printed}};

}  // namespace

const std::vector<ConductRun>& conduct_runs() {
  static const std::vector<ConductRun> runs = {{"line", "line"},
                                               {"E3", "decay"},
                                               {"E3s", "decay-scaled"},
                                               {"E3 small", "decay-small"},
                                               {"E3 within", "decay-bounded"},
                                               {kOnTwoThreads, "decay", 20'000, 2},
                                               {"RB", "valley"},
                                               {kShort, "valley", kBudget},
                                               {"RBb", "valley-bounded,scale-unknowns=false"},
                                               {"QD", "solved"},
                                               {"missing", "missing"}};
  return runs;
}

std::vector<ConductCell> conduct_of(const Catalog& catalog,
                                    const std::map<std::string, Record>& records) {
  std::vector<ConductCell> cells;
  for (const Column& column : kColumns) {
    Runs runs(catalog, records);
    Cell cell;
    try {
      cell = column.measure(runs);
    } catch (const NotRun& why) {
      cell = why.cell;
    }
    cells.push_back({column.name, cell.holds, cell.figures, std::move(runs.used)});
  }
  return cells;
}

void measure_conduct(const Catalog& catalog, std::vector<AuditedOptimizer>& audits,
                     const std::filesystem::path& folder) {
  std::vector<Request> requests;
  for (const ConductRun& run : conduct_runs())  // those of one problem in one process
    for (const AuditedOptimizer& audited : audits)
      requests.push_back(
          named({.problem = complete_problem(
                     catalog, parse_spec(fmt::format("conduct[input={}]", run.input))),
                 .optimizer = complete_optimizer(catalog, parse_spec(audited.name)),
                 .budget = {.iterations = run.work, .work = run.work, .target = 0},
                 .threads = run.threads}));
  Store store(folder);
  const Outcome outcome =
      run_all(catalog, requests, store,
              {.jobs = one_a_core(), .keeps_output = true, .command = "isoline audit --conduct"});
  require(!outcome.is_interrupted, "the measurement of conduct was interrupted");
  std::size_t next = 0;
  std::vector<std::map<std::string, Record>> records(audits.size());
  for (const ConductRun& run : conduct_runs())
    for (auto& of_method : records)
      if (auto record = store.find(requests[next++])) of_method.emplace(run.name, *record);
  for (std::size_t i = 0; i < audits.size(); ++i) {
    const auto is_run = [](const auto& one) { return one.second.status != Status::inapplicable; };
    if (std::ranges::any_of(records[i], is_run))
      audits[i].conduct = conduct_of(catalog, records[i]);
  }
}

}  // namespace isoline::benchmarks
