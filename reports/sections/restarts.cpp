// Tables over single runs: any-time performance, work with its interval, restarts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/read/reached.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/words.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {
namespace {

constexpr Real kDigits = 10;               // of the targets: τ = 10^(−j/5), j = 0 … 50
constexpr std::size_t kMostProblems = 25;  // columns of a matrix

constexpr std::int64_t kAreaWork = 10'000;  // of areas, where a request sets no limit

// What an area is taken over: what was allowed, so that it does not depend on who else ran.
Real area_budget(const Request& request) {
  const std::int64_t work = request.budget.work;
  return Real(work < Budget{}.work ? work : kAreaWork);
}

Real area_of(const Run& run) {
  const auto& work = run.record->curve.work;
  return area_over_curve({work.begin(), work.end()}, left_of_aim(run),
                         area_budget(run.record->request), kDigits);
}

// Over all runs of an optimizer; inapplicable and missing cells hit nothing and stay in n.
struct Anytime {
  std::size_t pairs = 0, hits = 0, runs = 0;
  std::array<std::size_t, 4> within{};
  Real area = 0;
};
constexpr std::array<Real, 4> kWithin = {10, 100, 1000, 10'000};

Anytime anytime_of(const Comparison& c, std::size_t s) {
  const Measure by = cost_measure(c);
  Anytime all;
  for (const std::size_t p : c.order.settings) {
    const Cell& cell = c.cell(p, s);
    all.runs += cell.planned;
    all.pairs += cell.planned * kTargets;
    for (const std::size_t index : cell.runs) {
      const Run& run = c.runs[index];
      for (const Reached& reached : ladder_of(run, c.problems[p].prices, run.aim)) {
        const Real cost = in_units(by, reached.by(by));
        ++all.hits;
        for (std::size_t i = 0; i < kWithin.size(); ++i) all.within[i] += cost <= kWithin[i];
      }
      all.area += area_of(run);
    }
  }
  if (all.runs > 0) all.area /= Real(all.runs);
  return all;
}

std::vector<Attempt> attempts_of(const Comparison& c, const Cell& cell) {
  const Measure by = cost_measure(c);
  std::vector<Attempt> attempts;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const Real taken = run.taken[by][kTightest];
    const bool is_success = taken < kNever;
    attempts.push_back({in_units(by, is_success ? taken : spent_by(run, by)), is_success});
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
  for (std::size_t p = 0; p < problems; ++p) table.columns.push_back(problem_name(c.problems[p]));
  table.columns.push_back("failed");
  for (std::size_t s = 0; s < listed_optimizers(c, kMostTableRows); ++s) {
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
          "Runtime distribution over 51 targets, 1 to 1e-10 of the way to what a problem aims at, "
          "evenly spaced in the logarithm, of every run: share met within so many " +
          cost_unit(c) +
          ". Area: over the convergence curve, 1 the best, up to the declared work that the run was "
          "allowed, 10,000 where it was not limited, so that it does not depend on who else ran. "
          "n: runs planned; those inapplicable, missing or failed meet no more.",
      .columns = {"optimizer", "≤ 10", "≤ 100", "≤ 1000", "≤ 10000", "at all", "area", "n runs",
                  "failed"},
      .rows = {}};
  Leading first;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    const Anytime all = anytime_of(c, s);
    const std::size_t pairs = std::max<std::size_t>(all.pairs, 1);
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (const std::size_t met : all.within) row.push_back(share_cell(met, pairs));
    row.push_back(share_cell(all.hits, pairs));
    row.push_back({fmt::format("{:.3f}", all.area), {{"area", all.area}}});
    row.push_back(count_cell(all.runs));
    row.push_back(failed_cell(c, s));
    first.offer(all.area, optimizer_text(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading = first.count == 0
                      ? "No run meets any target below its start: all areas are 0."
                      : fmt::format("The largest area over all targets and budgets, {:.3f}: {}.",
                                    first.value, first.names());
  return table;
}

Table interval_table(const Comparison& c) {
  Table table{
      .id = "cost-interval",
      .title = fmt::format("Cost to {}, with intervals", tau_name(c)),
      .reading = "",
      .caption = fmt::format(
          "Median over seeds in {}; in square brackets {}; and the runs that reached it, of all. A run that never reached it counts as infinite, ✗. Point at a cost for its raw counts; they are "
          "summed up under Oracle calls, and of every run in report.csv.",
          cost_unit(c), interval_words(c)),
      .columns = {"optimizer"},
      .rows = {}};
  std::size_t certain = 0, cells = 0;
  fill_matrix(c, table, [&](std::size_t p, std::size_t s, const Cell& cell) -> TableCell {
    const std::vector<Real> costs = costs_over_seeds(c, cell);
    const Spread spread = spread_of(costs);
    const std::string count = fmt::format("{}/{}", spread.n - spread.unsolved, spread.n);
    TableCell::Numbers numbers = {{"median", spread.median},
                                  {"reached", Real(spread.n - spread.unsolved)},
                                  {"n", Real(spread.n)}};
    ++cells;
    certain += spread.unsolved == 0;
    const std::string median = reached_figure(spread.median) + std::string(time_mark(c, cell));
    if (costs.size() < 2 || spread.low == spread.high)
      return {fmt::format("{} ({})", median, count), numbers};
    const Interval interval = interval_over_seeds(costs, key_of(c, p, s));
    numbers.push_back({"low", interval.low});
    numbers.push_back({"high", interval.high});
    return {fmt::format("{} [{}–{}] ({})", median, reached_figure(interval.low),
                        reached_figure(interval.high), count),
            numbers};
  });
  table.reading =
      fmt::format("In {} of {} cells every run reaches {}.", certain, cells, tau_name(c));
  return table;
}

Table restart_table(const Comparison& c) {
  Table table{
      .id = "restarts",
      .title = "Expected running time",
      .reading = "",
      .caption = fmt::format(
          "Cost to {} when a method restarts until it reaches it, in {}: all that was spent over "
          "the successes, and the middle 80 % of 1,000 simulated restarts drawn from the runs; ✗ "
          "where no run reached it. In brackets: runs that reached it, of all. The runs are of other seeds, so a "
          "restart here draws another instance, with another start and where the problem has one "
          "another target, too: it is the time to solve one of these, not to solve this one.",
          tau_name(c), cost_unit(c)),
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
    rescued += expected < kNever && !cell.headline[kTightest].is_solved();
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
  table.reading = fmt::format("Only restarts reach it in {}: the median run does not.",
                              counted(rescued, "cell"));
  return table;
}

}  // namespace isoline::reports
