// Reads records into rows, and pivots rows into cells of a problem and an optimizer.
#include "core/results/table.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "core/results/labels.h"
#include "core/threads.h"

namespace isoline::results {
namespace {

// Places of names on an axis.
template <class Axis>
std::unordered_map<std::string, std::size_t> places(const std::vector<Axis>& axis,
                                                    std::string Axis::*name) {
  std::unordered_map<std::string, std::size_t> at;
  for (std::size_t i = 0; i < axis.size(); ++i) at.emplace(axis[i].*name, i);
  return at;
}

Run run_of(const Record& record, const ProblemAxis& problem, const BestKnown& best) {
  Run run{.record = &record,
          .seed = record.request.seed,
          .aim = problem.aim,
          .targets = {},
          .is_timed_alone = record.provenance.run.is_timed_alone()};
  if (record.status == Status::inapplicable) return run;
  run.minimum = best.minimum(record);
  run.scale = best.scale(record);
  run.spent = problem.prices.cost(record);
  std::vector<Reached> loss = targets_met(record, problem.prices, Aim::loss, best),
                       x = targets_met(record, problem.prices, Aim::x, best);
  run.loss_met = loss.size();
  run.x_met = x.size();
  run.targets = std::move(run.aim == Aim::x ? x : loss);
  run.targets.shrink_to_fit();
  return run;
}

// A run with two labels stands in two rows.
void fill_runs(Table& table, const OptimizerLabels& labels) {
  const auto problem = places(table.problems, &ProblemAxis::spec),
             optimizer = places(table.optimizers, &OptimizerAxis::label);
  const std::vector<Record>& records = table.study->runs;
  const BestKnown best(*table.study);
  std::vector<Run> read(records.size());
  share(records.size(), [&](std::size_t i) {
    const std::size_t p = problem.at(records[i].request.problem.spec);
    read[i] = run_of(records[i], table.problems[p], best);
    read[i].problem = p;
  });
  std::unordered_set<std::string> answered;
  for (Run& run : read) {
    const Request& request = run.record->request;
    answered.insert(run.record->cell);
    const std::vector<std::string> names = labels.of(request.problem.spec, request.optimizer.spec);
    for (std::size_t i = 0; i < names.size(); ++i) {
      run.optimizer = optimizer.at(names[i]);
      run.is_repeated = i > 0;
      if (i + 1 < names.size())
        table.runs.push_back(run);
      else
        table.runs.push_back(std::move(run));
    }
  }
  for (const PlannedCell& cell : table.study->plan.cells) {
    if (answered.contains(cell.cell)) {
      ++table.answered;
      continue;
    }
    table.missing.push_back(cell);
    for (const std::string& name : labels.of(cell.problem, cell.optimizer))
      table.absent.push_back({.problem = problem.at(cell.problem),
                              .optimizer = optimizer.at(name),
                              .seed = cell.seed,
                              .targets = {}});
  }
  table.planned = table.study->plan.cells.size();
  if (table.planned == 0) table.planned = table.answered = records.size();
}

void count_runs(Table& table) {
  std::set<std::uint64_t> seeds;
  for (std::size_t row = 0; row < table.runs.size(); ++row) {
    const Run& run = table.runs[row];
    if (run.is_repeated) continue;
    const Status status = run.record->status;
    ++table.statuses[status];
    if (is_failure(status)) table.failures.push_back(row);
    seeds.insert(run.seed);
    table.is_any_timed_together = table.is_any_timed_together || !run.is_timed_alone;
  }
  table.seeds.assign(seeds.begin(), seeds.end());
}

// The settings of a problem that more than half of its methods were run on: a method that lacks one
// of them is not compared on the rest. Without a plan, half are enough.
std::set<std::uint64_t> usual_seeds(const std::vector<std::set<std::uint64_t>>& asked,
                                    bool has_plan) {
  std::map<std::uint64_t, std::size_t> counts;
  std::size_t methods = 0;
  for (const auto& seeds : asked) {
    methods += !seeds.empty();
    for (const std::uint64_t seed : seeds) ++counts[seed];
  }
  std::set<std::uint64_t> usual;
  for (const auto& [seed, count] : counts)
    if (2 * count > methods || (!has_plan && 2 * count == methods)) usual.insert(seed);
  return usual;
}

// Puts rows into cells and counts the seeds each cell lacks. They never got anywhere: leaving a run
// out betters no median.
void fill_cells(const Table& table, Pivot& cells) {
  using Seeds = std::vector<std::vector<std::set<std::uint64_t>>>;  // [problem][optimizer]
  Seeds asked(table.problems.size(), {table.optimizers.size(), std::set<std::uint64_t>()});
  for (std::size_t row = 0; row < table.runs.size(); ++row) {
    const Run& run = table.runs[row];
    cells[run.problem][run.optimizer].runs.push_back(row);
    asked[run.problem][run.optimizer].insert(run.seed);
  }
  for (const Run& run : table.absent) asked[run.problem][run.optimizer].insert(run.seed);
  for (std::size_t p = 0; p < cells.size(); ++p) {
    const auto usual = usual_seeds(asked[p], !table.study->plan.cells.empty());
    for (std::size_t s = 0; s < cells[p].size(); ++s) {
      std::set<std::uint64_t>& all = asked[p][s];
      if (all.empty()) continue;
      all.insert(usual.begin(), usual.end());
      for (const std::size_t row : cells[p][s].runs) all.erase(table.runs[row].seed);
      cells[p][s].planned = cells[p][s].runs.size() + all.size();
    }
  }
}

void fill_medians(const Table& table, Cell& cell) {
  const auto median_to = [&](Measure by, std::size_t target) {
    return table
        .aggregate(
            cell.runs, [&](const Run& run) { return run.taken(by, target); }, cell.missing())
        .median;
  };
  for (std::size_t j = 0; j < kTargets && median_to(Measure::work, j) < kNever; ++j)
    for (const Measure by : kMeasures)
      cell.medians[static_cast<std::size_t>(by)].push_back(median_to(by, j));
}

void aggregate(const Table& table, const Yardstick& yardstick, Cell& cell) {
  if (cell.runs.empty()) return;
  bool is_truth_known = false;
  for (const std::size_t row : cell.runs) {
    const Run& run = table.runs[row];
    ++cell.statuses[run.record->status];
    cell.failed += is_failure(run.record->status);
    is_truth_known = is_truth_known || !std::isnan(run.record->summary.start_x_error);
    cell.is_timed_alone = cell.is_timed_alone && run.is_timed_alone;
    add_missing(cell.privileges, run.record->privileges);
  }
  if (cell.statuses[Status::inapplicable] == cell.runs.size()) {
    const std::string& reason = table.runs[cell.runs[0]].record->message;
    cell.inapplicable = reason.empty() ? "no reason given" : reason;
    return;
  }
  std::erase_if(cell.statuses, [](const auto& status) { return status.second == 0; });
  fill_medians(table, cell);
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    const std::size_t target = yardstick.tolerances[t].rung;
    for (const Measure by : kMeasures)
      cell.taken[by][t] = table.aggregate(
          cell.runs, [&](const Run& run) { return run.taken(by, target); }, cell.missing());
    cell.is_bound[t] = std::ranges::any_of(cell.runs, [&](std::size_t row) {
      const std::vector<Reached>& targets = table.runs[row].targets;
      return target < targets.size() && targets[target].is_bound;
    });
  }
  cell.headline = cell.taken[yardstick.by];
  cell.loss = table.aggregate(cell.runs, [](const Run& run) { return run.record->summary.loss; });
  if (is_truth_known)
    cell.x_error =
        table.aggregate(cell.runs, [](const Run& run) { return run.record->summary.x_error; });
}

}  // namespace

std::string marks_text(const Marks& marks) {
  return std::string(marks.is_foreign ? " ‡" : "") + (marks.has_extra_information ? " †" : "") +
         (marks.is_imported ? " §" : "");
}

Real Run::spent_by(Measure by) const {
  const Summary& summary = record->summary;
  return by == Measure::work         ? Real(summary.work)
         : by == Measure::cost       ? spent
         : by == Measure::iterations ? Real(summary.iterations)
                                     : summary.wall_seconds;
}

std::vector<Real> losses_left(const Run& run) {
  std::vector<Real> left;
  for (const Real loss : run.record->curve.loss)
    left.push_back(run.scale > 0 ? std::max(loss - run.minimum, 0.0) / run.scale : kNever);
  return left;
}

Table table_of(const Study& study) {
  const OptimizerLabels labels(study);
  Table table{.study = &study,
              .problems = problem_axis(study),
              .optimizers = optimizer_axis(study, labels)};
  fill_runs(table, labels);
  count_runs(table);
  return table;
}

Pivot pivot(const Table& table, const Yardstick& yardstick) {
  Pivot cells(table.problems.size(), std::vector<Cell>(table.optimizers.size()));
  fill_cells(table, cells);
  share(cells.size(), [&](std::size_t p) {
    for (Cell& cell : cells[p]) aggregate(table, yardstick, cell);
  });
  return cells;
}

void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some) {
  for (const std::string& one : some)
    if (std::ranges::find(all, one) == all.end()) all.push_back(one);
}

std::map<std::string, std::vector<std::size_t>> problems_by_name(const Table& table) {
  std::map<std::string, std::vector<std::size_t>> names;
  for (std::size_t p = 0; p < table.problems.size(); ++p)
    names[table.problems[p].name].push_back(p);
  return names;
}

}  // namespace isoline::results
