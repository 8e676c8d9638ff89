// Tables over single runs: any-time performance, work with its interval, restarts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/read/reached.h"
#include "reports/sections/evidence.h"
#include "reports/sections/words.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {

constexpr Real kDigits = 10;               // of the targets: τ = 10^(−j/5), j = 0 … 50
constexpr std::size_t kMostProblems = 25;  // columns of a matrix

// The most that any run of a problem spent: the common budget of its areas.
Real budget_of(const Comparison& c, std::size_t problem) {
  Real most = 0;
  for (const Cell& cell : c.cells[problem])
    for (const std::size_t run : cell.runs) most = std::max(most, c.runs[run].spent);
  return most;
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
      const Prices& prices = c.problems[p].prices;
      for (const Real cost : target_costs(run, prices, kTargets)) {
        all.hits += cost < kNever;
        for (std::size_t i = 0; i < kWithin.size(); ++i) all.within[i] += cost <= kWithin[i];
      }
      all.area +=
          area_over_curve(prices.curve_costs(*run.record), left_of_aim(run), budgets[p], kDigits);
    }
  }
  if (all.runs > 0) all.area /= Real(all.runs);
  return all;
}

std::vector<Attempt> attempts_of(const Comparison& c, const Cell& cell) {
  std::vector<Attempt> attempts;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const bool is_success = run.taken[Measure::cost][kTightest] < kNever;
    attempts.push_back({is_success ? run.taken[Measure::cost][kTightest] : run.spent, is_success});
  }
  return attempts;
}

// The raw counts of the run in the middle of those that got there, for who points at its cost.
TableCell with_calls(const Comparison& c, const Cell& cell, TableCell shown) {
  std::vector<std::pair<Real, std::size_t>> reached;
  for (const std::size_t index : cell.runs)
    if (c.runs[index].taken[Measure::work][kTightest] < kNever)
      reached.emplace_back(c.runs[index].taken[Measure::work][kTightest], index);
  if (reached.empty()) return shown;
  std::ranges::sort(reached);
  const auto [work, middle] = reached[(reached.size() - 1) / 2];
  const OracleCounts counts = counts_at(*c.runs[middle].record, work);
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (counts[kind] > 0)
      shown.note +=
          fmt::format("{}{} {}", shown.note.empty() ? "" : ", ", counts[kind], kOracleNames[kind]);
  return shown;
}

// A matrix of optimizers and problems whose cells `text` writes.
template <class Text>
void fill_matrix(const Comparison& c, Table& table, Text text) {
  const std::size_t problems = std::min(c.problems.size(), kMostProblems);
  for (std::size_t p = 0; p < problems; ++p)
    table.columns.push_back(shown_spec(c.problems[p].spec));
  table.columns.push_back("failed");
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (std::size_t p = 0; p < problems; ++p) {
      const Cell& cell = c.cell(p, s);
      row.push_back(cell.planned == 0    ? TableCell("")
                    : cell.runs.empty()  ? TableCell("missing")
                    : cell.is_measured() ? with_calls(c, cell, text(p, s, cell))
                                         : TableCell("n/a"));
    }
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  columns_are_problems(table, problems);
}

std::string key_of(const Comparison& c, std::size_t p, std::size_t s) {
  return c.problems[p].spec + " " + c.optimizers[s].label;
}

}  // namespace

Table anytime_table(const Comparison& c) {
  Table table{
      .id = "anytime",
      .title = "Any-time performance",
      .reading = "",
      .caption =
          "Runtime distribution over 51 targets, 1 to 1e-10 of the descent, evenly spaced in "
          "the logarithm, of every run: share met within so many " +
          cost_unit(c) +
          ". Area: over the convergence curve, 1 the best, up to the most that any run of the "
          "problem spent. n: runs planned; those inapplicable, missing or failed meet no more.",
      .columns = {"optimizer", "≤ 10", "≤ 100", "≤ 1000", "≤ 10000", "at all", "area", "n runs",
                  "failed"},
      .rows = {}};
  std::vector<Real> budgets;
  for (std::size_t p = 0; p < c.problems.size(); ++p) budgets.push_back(budget_of(c, p));
  Real best = -1;
  std::string leader;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    const Anytime all = anytime_of(c, s, budgets);
    const std::size_t pairs = std::max<std::size_t>(all.pairs, 1);
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (const std::size_t met : all.within) row.push_back(share_cell(met, pairs));
    row.push_back(share_cell(all.hits, pairs));
    row.push_back({fmt::format("{:.3f}", all.area), {{"area", all.area}}});
    row.push_back(count_cell(all.runs));
    row.push_back(failed_cell(c, s));
    if (all.area > best) {
      best = all.area;
      leader = optimizer_text(c, s);
    }
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading =
      fmt::format("Over all targets and budgets {} has the largest area, {:.3f}.", leader, best);
  return table;
}

Table interval_table(const Comparison& c) {
  Table table{
      .id = "cost-interval",
      .title = "Cost to 1e-6, with intervals",
      .reading = "",
      .caption =
          "Median over seeds in " + cost_unit(c) +
          ", its 95 % bootstrap interval over seeds (1,000 draws), and runs that got there of all. "
          "What never got there counts as infinite, ✗. Point at a cost for its raw counts; they "
          "are summed up under Oracle calls, and of every run in report.csv.",
      .columns = {"optimizer"},
      .rows = {}};
  std::size_t certain = 0, cells = 0;
  fill_matrix(c, table, [&](std::size_t p, std::size_t s, const Cell& cell) -> TableCell {
    std::vector<Real> costs;
    for (const std::size_t run : cell.runs)
      costs.push_back(c.runs[run].taken[Measure::cost][kTightest]);
    const Spread& spread = cell.taken[Measure::cost][kTightest];
    const std::string count = fmt::format("{}/{}", spread.n - spread.unsolved, spread.n);
    TableCell::Numbers numbers = {{"median", spread.median},
                                  {"reached", Real(spread.n - spread.unsolved)},
                                  {"n", Real(spread.n)}};
    ++cells;
    certain += spread.unsolved == 0;
    if (costs.size() < 2 || spread.low == spread.high)
      return {fmt::format("{} ({})", reached_figure(spread.median), count), numbers};
    const Interval interval = bootstrap_median(costs, key_of(c, p, s));
    numbers.push_back({"low", interval.low});
    numbers.push_back({"high", interval.high});
    return {fmt::format("{} [{}–{}] ({})", reached_figure(spread.median),
                        reached_figure(interval.low), reached_figure(interval.high), count),
            numbers};
  });
  table.reading = fmt::format("In {} of {} cells every run reaches 1e-6.", certain, cells);
  return table;
}

Table restart_table(const Comparison& c) {
  Table table{
      .id = "restarts",
      .title = "Expected running time",
      .reading = "",
      .caption = "Cost to 1e-6 when a method restarts until it gets there, in " + cost_unit(c) +
                 ": all that was spent over the successes, and the middle 80 % of 1,000 simulated "
                 "restarts "
                 "drawn from the runs; ✗ where no run got there. Runs that got there of all.",
      .columns = {"optimizer"},
      .rows = {}};
  std::size_t rescued = 0;
  fill_matrix(c, table, [&](std::size_t p, std::size_t s, const Cell& cell) -> TableCell {
    const std::vector<Attempt> attempts = attempts_of(c, cell);
    const auto successes = std::ranges::count_if(attempts, &Attempt::is_success);
    const Real expected = expected_running_time(attempts);
    const std::string count = fmt::format("({}/{})", successes, attempts.size());
    TableCell::Numbers numbers = {
        {"expected", expected}, {"reached", Real(successes)}, {"n", Real(attempts.size())}};
    rescued += expected < kNever && !cell.taken[Measure::cost][kTightest].is_solved();
    if (expected == kNever || attempts.size() < 2)
      return {fmt::format("{} {}", reached_figure(expected), count), numbers};
    const std::vector<Real> costs = simulated_restarts(attempts, key_of(c, p, s));
    const Real low = quantile(costs, 0.1), high = quantile(costs, 0.9);
    if (low == high) return {fmt::format("{} {}", reached_figure(expected), count), numbers};
    numbers.push_back({"low", low});
    numbers.push_back({"high", high});
    return {
        fmt::format("{} [{}–{}] {}", reached_figure(expected), figure(low), figure(high), count),
        numbers};
  });
  table.reading =
      fmt::format("In {} cells restarts get there where the median run does not.", rescued);
  return table;
}

}  // namespace isoline::reports
