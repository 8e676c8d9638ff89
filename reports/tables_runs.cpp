// Tables over single runs: any-time performance, work with its interval, restarts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/runtimes.h"
#include "reports/tables.h"
#include "reports/text.h"

namespace isoline {
namespace {

constexpr Real kDigits = 10;  // of the targets: τ = 10^(−j/5), j = 0 … 50
constexpr std::size_t kTargets = 51;
constexpr std::size_t kMostProblems = 25;  // columns of a matrix

// What is left of the descent at each point of a run's curve.
std::vector<Real> gaps_of(const Run& run) {
  std::vector<Real> gaps;
  const Real descent = run.record->summary.start_loss - run.minimum;
  for (const Real loss : run.record->curve.loss)
    gaps.push_back(descent > 0 ? std::max(loss - run.minimum, 0.0) / descent : kNever);
  return gaps;
}

// Work at which each of the 51 targets was first met: from the hits, else read off the curve.
std::vector<Real> runtimes_of(const Run& run) {
  std::vector<Real> all(kTargets, kNever);
  const Record& record = *run.record;
  if (record.status == Status::inapplicable) return all;
  if (record.hits) {
    for (std::size_t j = 0; j < std::min(kTargets, record.hits->iteration.size()); ++j)
      if (record.hits->iteration[j] >= 0) all[j] = Real(record.hits->work[j]);
    return all;
  }
  const std::vector<Real> gaps = gaps_of(run);
  std::size_t j = 0;
  for (std::size_t i = 0; i < gaps.size(); ++i)
    for (; j < kTargets && gaps[i] <= std::pow(10.0, -0.2 * Real(j)); ++j)
      all[j] = Real(record.curve.work[i]);
  return all;
}

// The most that any run of a problem spent: the common budget of its areas.
Real budget_of(const Comparison& c, std::size_t problem) {
  Real most = 0;
  for (const Cell& cell : c.cells[problem])
    for (const std::size_t run : cell.runs)
      most = std::max(most, Real(c.runs[run].record->summary.work));
  return most;
}

std::vector<Real> work_over_curve(const Run& run) {
  return {run.record->curve.work.begin(), run.record->curve.work.end()};
}

// Over all runs of an optimizer; inapplicable and missing cells hit nothing and stay in n.
struct Anytime {
  std::size_t pairs = 0, hits = 0, runs = 0;
  std::array<std::size_t, 4> within{};
  Real area = 0;
};
constexpr std::array<Real, 4> kWithin = {10, 100, 1000, 10'000};

Anytime anytime_of(const Comparison& c, std::size_t s, const std::vector<Real>& budgets) {
  Anytime all;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const Cell& cell = c.cell(p, s);
    all.runs += cell.planned;
    all.pairs += cell.planned * kTargets;
    for (const std::size_t index : cell.runs) {
      const Run& run = c.runs[index];
      for (const Real work : runtimes_of(run)) {
        all.hits += work < kNever;
        for (std::size_t i = 0; i < kWithin.size(); ++i) all.within[i] += work <= kWithin[i];
      }
      all.area += area_over_curve(work_over_curve(run), gaps_of(run), budgets[p], kDigits);
    }
  }
  if (all.runs > 0) all.area /= Real(all.runs);
  return all;
}

std::vector<Attempt> attempts_of(const Comparison& c, const Cell& cell) {
  std::vector<Attempt> attempts;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const bool is_success = run.work[kTightest] < kNever;
    attempts.push_back(
        {is_success ? run.work[kTightest] : Real(run.record->summary.work), is_success});
  }
  return attempts;
}

// A matrix of optimizers and problems whose cells `text` writes.
template <class Text>
void fill_matrix(const Comparison& c, StatisticTable& table, Text text) {
  const std::size_t problems = std::min(c.problems.size(), kMostProblems);
  for (std::size_t p = 0; p < problems; ++p)
    table.columns.push_back(shown_spec(c.problems[p].spec));
  table.columns.push_back("failed");
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    std::vector<std::string> row = {optimizer_text(c, s)};
    for (std::size_t p = 0; p < problems; ++p) {
      const Cell& cell = c.cell(p, s);
      row.push_back(cell.planned == 0    ? ""
                    : cell.runs.empty()  ? "missing"
                    : cell.is_measured() ? text(p, s, cell)
                                         : "n/a");
    }
    row.push_back(failed_text(c, s));
    table.rows.push_back(std::move(row));
  }
}

std::string key_of(const Comparison& c, std::size_t p, std::size_t s) {
  return c.problems[p].spec + " " + c.optimizers[s].label;
}

}  // namespace

StatisticTable anytime_table(const Comparison& c) {
  StatisticTable table{
      .id = "anytime",
      .title = "Any-time performance",
      .reading = "",
      .caption =
          "Runtime distribution over 51 targets, 1 to 1e-10 of the descent, evenly spaced in "
          "the logarithm, of every run: share met within so many forward solves. Area: over "
          "the convergence curve, 1 the best, up to the most work that any run of the problem "
          "spent. n: runs planned; those inapplicable, missing or failed meet no more.",
      .columns = {"optimizer", "≤ 10", "≤ 100", "≤ 1000", "≤ 10000", "at all", "area", "n runs",
                  "failed"},
      .rows = {}};
  std::vector<Real> budgets;
  for (std::size_t p = 0; p < c.problems.size(); ++p) budgets.push_back(budget_of(c, p));
  Real best = -1;
  std::string leader;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    const Anytime all = anytime_of(c, s, budgets);
    const Real pairs = Real(std::max<std::size_t>(all.pairs, 1));
    std::vector<std::string> row = {optimizer_text(c, s)};
    for (const std::size_t met : all.within) row.push_back(percent(Real(met) / pairs));
    row.push_back(percent(Real(all.hits) / pairs));
    row.push_back(fmt::format("{:.3f}", all.area));
    row.push_back(std::to_string(all.runs));
    row.push_back(failed_text(c, s));
    if (all.area > best) best = all.area, leader = optimizer_text(c, s);
    table.rows.push_back(std::move(row));
  }
  table.reading =
      fmt::format("Over all targets and budgets {} has the largest area, {:.3f}.", leader, best);
  return table;
}

StatisticTable interval_table(const Comparison& c) {
  StatisticTable table{
      .id = "work-interval",
      .title = "Work to 1e-6, with intervals",
      .reading = "",
      .caption =
          "Median over seeds in forward solves, its 95 % bootstrap interval over seeds (1,000 "
          "draws), and runs that got there of all. What never got there counts as infinite, ✗.",
      .columns = {"optimizer"},
      .rows = {}};
  std::size_t certain = 0, cells = 0;
  fill_matrix(c, table, [&](std::size_t p, std::size_t s, const Cell& cell) {
    std::vector<Real> work;
    for (const std::size_t run : cell.runs) work.push_back(c.runs[run].work[kTightest]);
    const Spread& spread = cell.work[kTightest];
    const std::string count = fmt::format("{}/{}", spread.n - spread.unsolved, spread.n);
    ++cells;
    certain += spread.unsolved == 0;
    if (work.size() < 2 || spread.low == spread.high)
      return fmt::format("{} ({})", reached_figure(spread.median), count);
    const Interval interval = bootstrap_median(work, key_of(c, p, s));
    return fmt::format("{} [{}–{}] ({})", reached_figure(spread.median),
                       reached_figure(interval.low), reached_figure(interval.high), count);
  });
  table.reading = fmt::format("In {} of {} cells every run reaches 1e-6.", certain, cells);
  return table;
}

StatisticTable restart_table(const Comparison& c) {
  StatisticTable table{
      .id = "restarts",
      .title = "Expected running time",
      .reading = "",
      .caption =
          "Work to 1e-6 when a method restarts until it gets there: all work spent over the "
          "successes, and the middle 80 % of 1,000 simulated restarts drawn from the runs; ✗ "
          "where no run got there. Runs that got there of all.",
      .columns = {"optimizer"},
      .rows = {}};
  std::size_t rescued = 0;
  fill_matrix(c, table, [&](std::size_t p, std::size_t s, const Cell& cell) {
    const std::vector<Attempt> attempts = attempts_of(c, cell);
    const auto successes = std::ranges::count_if(attempts, &Attempt::is_success);
    const Real expected = expected_running_time(attempts);
    const std::string count = fmt::format("({}/{})", successes, attempts.size());
    rescued += expected < kNever && !cell.work[kTightest].is_solved();
    if (expected == kNever || attempts.size() < 2)
      return fmt::format("{} {}", reached_figure(expected), count);
    const std::vector<Real> costs = simulated_restarts(attempts, key_of(c, p, s));
    const Real low = quantile(costs, 0.1), high = quantile(costs, 0.9);
    if (low == high) return fmt::format("{} {}", reached_figure(expected), count);
    return fmt::format("{} [{}–{}] {}", reached_figure(expected), figure(low), figure(high), count);
  });
  table.reading =
      fmt::format("In {} cells restarts get there where the median run does not.", rescued);
  return table;
}

}  // namespace isoline
