// The table of expected running times, by restarts.
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

constexpr std::size_t kMostProblems = 25;  // columns of a matrix

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
