// Tables of costs: counts of oracle calls with their total cost, measured costs, expected running
// times with restarts, and the work of every optimizer on each problem.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/results/statistics.h"
#include "core/results/study.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// The calls of all runs of an optimizer that reached the tightest tolerance, until then.
struct Calls {
  std::array<Real, kOracles> counts{};
  Real work = 0, cost = 0;
  std::size_t reached = 0, runs = 0;
};

Calls calls_of(const Comparison& c, std::size_t s) {
  Calls calls;
  for (const auto& cells : c.cells) {
    calls.runs += cells[s].planned;
    for (const std::size_t row : cells[s].runs) {
      const Run& run = c.runs[row];
      const Real work = c.taken(run, Measure::work, kTightest);
      if (work == kNever) continue;
      ++calls.reached;
      calls.work += work;
      calls.cost += c.taken(run, Measure::cost, kTightest);
      const OracleCounts counts = counts_at(*run.record, work);
      for (std::size_t kind = 0; kind < kOracles; ++kind) calls.counts[kind] += Real(counts[kind]);
    }
  }
  return calls;
}

TableCell price_cell(const MeasuredPrices& prices, std::string_view oracle) {
  const MeasuredPrice* price = price_of(prices, oracle);
  if (price == nullptr) return "";
  TableCell cell{fmt::format("{} : {} [{}–{}]", price->declared, figure(price->price),
                             figure(price->low), figure(price->high)),
                 {{"declared", Real(price->declared)},
                  {"measured", price->price},
                  {"low", price->low},
                  {"high", price->high}}};
  if (!is_told(prices, *price)) cell.remark = "nominal cost used";
  return cell;
}

}  // namespace

const MeasuredPrice* price_of(const MeasuredPrices& prices, std::string_view oracle) {
  const auto at = std::ranges::find(prices.oracles, oracle, &MeasuredPrice::oracle);
  return at == prices.oracles.end() ? nullptr : &*at;
}

const MeasuredPrices* prices_of(const ProblemAxis& problem) {
  return problem.has_own_sheet() && problem.sheet->prices ? &*problem.sheet->prices : nullptr;
}

Table calls_table(const Comparison& c) {
  Table table = worded_table("calls", tau_name(c), priced_unit(c));
  std::vector<Calls> all;
  std::array<bool, kOracles> is_asked{};
  Real work = 0, cost = 0;
  for (std::size_t s = 0; s < std::min(c.optimizers.size(), kMostTableRows); ++s) {
    const Calls& calls = all.emplace_back(calls_of(c, s));
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      is_asked[kind] = is_asked[kind] || calls.counts[kind] > 0;
    work += calls.work;
    cost += calls.cost;
  }
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (is_asked[kind]) table.columns.emplace_back(kOracleNames[kind]);
  for (const char* column : {"work", "cost", "own time", "n runs", "failed"})
    table.columns.push_back(column);
  for (std::size_t s = 0; s < all.size(); ++s) {
    std::vector<TableCell> row = {count_cell(all[s].reached)};
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      if (is_asked[kind]) row.push_back(number_cell("sum", all[s].counts[kind]));
    row.push_back(number_cell("sum", all[s].work));
    row.push_back(number_cell("sum", all[s].cost));
    const Spread own = own_time(c, s);
    row.push_back(
        own.n == 0 ? TableCell("")
                   : TableCell(percent(own.median), {{"median", own.median}, {"n", Real(own.n)}}));
    row.push_back(count_cell(all[s].runs));
    row.push_back(failed_cell(c, s));
    add_row(table, c, s, std::move(row));
  }
  table.reading = words("calls.reading", work, cost, priced_unit(c));
  return table;
}

Table prices_table(const Comparison& c) {
  Table table = worded_table("prices");
  std::vector<std::string_view> oracles;
  for (const std::string_view oracle : kOracleNames)
    if (oracle != "forward" && std::ranges::any_of(c.problems, [&](const ProblemAxis& problem) {
          const MeasuredPrices* prices = prices_of(problem);
          return prices != nullptr && price_of(*prices, oracle) != nullptr;
        }))
      oracles.push_back(oracle);
  table.columns.insert(table.columns.end(), oracles.begin(), oracles.end());
  std::size_t measured = 0, untold = 0;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const MeasuredPrices* prices = prices_of(c.problems[p]);
    if (prices == nullptr) continue;
    table.row_topics.push_back({.problem = p});
    std::vector<TableCell> row = {problem_name(c.problems[p]),
                                  number_cell("microseconds", 1e6 * prices->forward_seconds)};
    for (const std::string_view oracle : oracles) row.push_back(price_cell(*prices, oracle));
    for (const MeasuredPrice& price : prices->oracles) {
      if (price.oracle == kInference) continue;  // no run asks it: it counts in no cost
      ++measured;
      untold += !is_told(*prices, price);
    }
    table.rows.push_back(std::move(row));
  }
  table.reading = words(measured == 0 ? "prices.none"
                        : untold == 0 ? "prices.all"
                                      : "prices.some",
                        measured, untold);
  return table;
}

// Problem by problem: what this data shows of each, and the work of every optimizer on it.
Section problems_section(const Comparison& c) {
  constexpr std::size_t kMostColumns = 7;  // problems: more side by side are too wide to read
  Section section = worded_section("problems");
  Table table = worded_table("matrix", counted_to_tau(c), success_text(c), marks_legend(c));
  table.is_folded = c.problems.size() > kMostColumns;
  table.most_columns = kMostColumns;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const std::string name = problem_name(c.problems[p]);
    section.readings.push_back({name, curve_reading(c, p)});
    table.columns.push_back(name);
  }
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (std::size_t p = 0; p < c.problems.size(); ++p) {
      const Cell& cell = c.cell(p, s);
      TableCell& shown = row.emplace_back(matrix_text(c, cell, kTightest));
      shown.is_best = cell.is_best[kTightest];
      if (cell.is_measured() && !is_complete(cell, kTightest))
        shown.remark = count_text(cell, kTightest);
    }
    table.rows.push_back(std::move(row));
  }
  section.tables.push_back(std::move(table));
  return section;
}

// The table of expected running times, by restarts.

namespace {

// The cost of restarts on one cell; `rescued` counts cells that only restarts solve.
TableCell restart_cell(const Comparison& c, std::size_t p, std::size_t s, std::size_t& rescued) {
  const Cell& cell = c.cell(p, s);
  if (!cell.is_measured()) return cell.planned == 0 ? "" : cell.runs.empty() ? "missing" : "n/a";
  const Measure by = cost_measure(c);
  std::vector<Attempt> attempts;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const Real taken = c.taken(run, by, kTightest);
    const bool is_success = taken < kNever;
    attempts.push_back({in_units(by, is_success ? taken : run.spent_by(by)), is_success});
  }
  const auto successes = std::ranges::count_if(attempts, &Attempt::is_success);
  const Real expected = expected_running_time(attempts);
  TableCell shown{
      reached_figure(expected),
      {{"expected", expected}, {"reached", Real(successes)}, {"n", Real(attempts.size())}}};
  rescued += expected < kNever && !cell.headline[kTightest].is_solved();
  const bool is_few = attempts.size() < kFewestForInterval;
  if (expected < kNever && (!is_few || std::cmp_equal(successes, attempts.size()))) {
    const std::string key = c.problems[p].spec + " " + c.optimizers[s].label;
    const std::vector<Real> costs = simulated_restarts(attempts, key);
    const auto [least, most] = std::ranges::minmax(attempts, {}, &Attempt::cost);
    const Real low = is_few ? least.cost : quantile(costs, 0.1);
    const Real high = is_few ? most.cost : quantile(costs, 0.9);
    if (low < high) {
      shown.text += fmt::format(" [{}–{}]", figure(low), figure(high));
      shown.numbers.push_back({"low", low});
      shown.numbers.push_back({"high", high});
    }
  }
  shown.text += fmt::format(" ({}/{})", successes, attempts.size());
  return shown;
}

}  // namespace

Table restart_table(const Comparison& c) {
  constexpr std::size_t kMostProblems = 25;  // columns of a matrix
  Table table = worded_table("restarts", tau_name(c), cost_unit(c));
  const std::size_t problems = std::min(c.problems.size(), kMostProblems);
  table.column_topics.emplace_back();
  for (std::size_t p = 0; p < problems; ++p) {
    table.columns.push_back(problem_name(c.problems[p]));
    table.column_topics.push_back({.problem = p});
  }
  table.columns.push_back("failed");
  std::size_t rescued = 0;
  for (std::size_t s = 0; s < std::min(c.optimizers.size(), kMostTableRows); ++s) {
    std::vector<TableCell> row;
    for (std::size_t p = 0; p < problems; ++p) row.push_back(restart_cell(c, p, s, rescued));
    row.push_back(failed_cell(c, s));
    add_row(table, c, s, std::move(row));
  }
  table.reading = words("restarts.reading", rescued);
  return table;
}

}  // namespace isoline::reports
