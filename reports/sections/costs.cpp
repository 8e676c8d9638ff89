// Tables of costs: raw counts of oracle calls with what they come to, and the prices themselves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/results/statistics.h"
#include "core/results/study.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
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

TableCell sum_cell(Real sum) { return {figure(sum), {{"sum", sum}}}; }

const MeasuredPrice* price_of(const MeasuredPrices& prices, std::string_view oracle) {
  const auto at = std::ranges::find(prices.oracles, oracle, &MeasuredPrice::oracle);
  return at == prices.oracles.end() ? nullptr : &*at;
}

// Also those that are not used.
const MeasuredPrices* prices_of(const ProblemAxis& problem) {
  return problem.has_own_sheet() && problem.sheet->prices ? &*problem.sheet->prices : nullptr;
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
  if (!is_told(prices, *price)) cell.remark = "nominal is used";
  return cell;
}

// A summary of the costs that are used.
struct PriceSummary {
  std::vector<Real> pullbacks;
  std::size_t measured = 0, untold = 0;
  Real distance = 0;  // of the one farthest from the declared price, by its logarithm
  std::string farthest = "none";

  void add(const MeasuredPrices& prices, const std::string& problem) {
    for (const MeasuredPrice& price : prices.oracles) {
      if (price.oracle == kInference) continue;  // no run asks it: it counts in no cost
      ++measured;
      untold += !is_told(prices, price);
      if (!is_told(prices, price)) continue;
      if (price.oracle == "pullback") pullbacks.push_back(price.price);
      if (price.declared == 0) continue;
      const Real away = std::abs(std::log(price.price / Real(price.declared)));
      if (away <= distance) continue;
      distance = away;
      farthest = fmt::format("{} of {}, declared {}, measured {}", price.oracle, problem,
                             price.declared, figure(price.price));
    }
  }
  std::string reading() const {
    if (measured == 0) return "These results contain no measured costs: nominal costs are used.";
    std::string text;
    if (!pullbacks.empty()) {
      const Spread spread = spread_of(pullbacks);
      text = fmt::format(
          "A pullback, with nominal cost 1, takes {:.3g} forward solves in the median of the {} "
          "where it is resolved, from {:.3g} to {:.3g}; farthest from its nominal cost: {}. ",
          spread.median, spread.n, spread.low, spread.high, farthest);
    }
    if (untold == 0) return text + "All measured costs are used.";
    return text + fmt::format(
                      "{} measured costs in total; {} are replaced by the nominal ones: there, a "
                      "call, "
                      "or the forward solve that is their unit, takes less than a microsecond, "
                      "which is mostly the overhead of any call, or the rounds disagree.",
                      measured, untold);
  }
};

}  // namespace

Table calls_table(const Comparison& c) {
  Table table{.id = "calls",
              .title = "Oracle calls",
              .reading = "",
              .caption = fmt::format(
                  "Raw counts until {} was met, summed over the runs that met it; their nominal "
                  "cost (work) and in {} (cost). For every single run: "
                  "report.csv.",
                  tau_name(c), priced_unit(c)),
              .columns = {"optimizer", "runs to " + tau_name(c)},
              .rows = {}};
  std::vector<Calls> all;
  std::array<bool, kOracles> is_asked{};
  for (std::size_t s = 0; s < listed_optimizers(c, kMostTableRows); ++s) {
    all.push_back(calls_of(c, s));
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      is_asked[kind] = is_asked[kind] || all.back().counts[kind] > 0;
  }
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (is_asked[kind]) table.columns.emplace_back(kOracleNames[kind]);
  for (const char* column : {"work", "cost", "n runs", "failed"}) table.columns.push_back(column);
  Real work = 0, cost = 0;
  for (std::size_t s = 0; s < all.size(); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s), count_cell(all[s].reached)};
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      if (is_asked[kind]) row.push_back(sum_cell(all[s].counts[kind]));
    row.push_back(sum_cell(all[s].work));
    row.push_back(sum_cell(all[s].cost));
    row.push_back(count_cell(all[s].runs));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
    work += all[s].work;
    cost += all[s].cost;
  }
  rows_are_optimizers(table);
  table.reading = fmt::format("All of these took {} forward solves at nominal cost, {} in {}.",
                              figure(work), figure(cost), priced_unit(c));
  return table;
}

Table prices_table(const Comparison& c) {
  Table table{
      .id = "prices",
      .title = "Prices",
      .reading = "",
      .caption =
          "The cost of the first call of an oracle at a new point, in forward solves: nominal : "
          "measured [middle 80 % of the rounds], in processor time, before the runs. The nominal "
          "cost is used if the call, or the forward solve, takes less than a microsecond, or the "
          "rounds "
          "disagree. Empty: not offered, or left out because it takes too long, and counted at its "
          "declared price.",
      .columns = {"problem", "forward, µs"},
      .rows = {}};
  std::vector<std::string_view> oracles;
  for (const std::string_view oracle : kOracleNames)
    if (oracle != "forward" && std::ranges::any_of(c.problems, [&](const ProblemAxis& problem) {
          const MeasuredPrices* prices = prices_of(problem);
          return prices != nullptr && price_of(*prices, oracle) != nullptr;
        }))
      oracles.push_back(oracle);
  table.columns.insert(table.columns.end(), oracles.begin(), oracles.end());
  PriceSummary summary;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const MeasuredPrices* prices = prices_of(c.problems[p]);
    if (prices == nullptr) continue;
    table.row_topics.push_back({.problem = p});
    const std::string name = problem_name(c.problems[p]);
    const Real microseconds = 1e6 * prices->forward_seconds;
    std::vector<TableCell> row = {name, {figure(microseconds), {{"microseconds", microseconds}}}};
    for (const std::string_view oracle : oracles) row.push_back(price_cell(*prices, oracle));
    summary.add(*prices, name);
    table.rows.push_back(std::move(row));
  }
  table.reading = summary.reading();
  return table;
}

// Problem by problem: what this data shows of each, and the work of every optimizer on it.

namespace {

constexpr std::size_t kMostColumns = 7;  // problems: more side by side are too wide to read

TableCell work_cell(const Comparison& c, const Cell& cell) {
  TableCell shown = matrix_text(c, cell, kTightest);
  shown.is_best = cell.is_best[kTightest];
  if (cell.is_measured() && !is_complete(cell, kTightest))
    shown.remark = count_text(cell, kTightest);
  return shown;
}

}  // namespace

Section problems_section(const Comparison& c) {
  Section section{.id = "problems", .title = "Problem by problem"};
  Table table{.id = "matrix",
              .title = "Every problem and optimizer",
              .caption = fmt::format(
                  "Median {}. Bold: the least of its problem. ✗: not reached by half of the "
                  "runs. (k/n): k of n runs reached it. n/a: not applicable. Empty: "
                  "not planned. {}",
                  counted_to_tau(c), marks_legend(c)),
              .columns = {"optimizer"},
              .is_folded = c.problems.size() > kMostColumns,
              .most_columns = kMostColumns};
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const std::string name = problem_name(c.problems[p]);
    section.readings.push_back({name, curve_reading(c, p)});
    table.columns.push_back(name);
  }
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (std::size_t p = 0; p < c.problems.size(); ++p) row.push_back(work_cell(c, c.cell(p, s)));
    table.rows.push_back(std::move(row));
  }
  section.tables.push_back(std::move(table));
  return section;
}

// The table of expected running times, by restarts.

namespace {

constexpr std::size_t kMostProblems = 25;  // columns of a matrix

std::vector<Attempt> attempts_of(const Comparison& c, const Cell& cell) {
  const Measure by = cost_measure(c);
  std::vector<Attempt> attempts;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const Real taken = c.taken(run, by, kTightest);
    const bool is_success = taken < kNever;
    attempts.push_back({in_units(by, is_success ? taken : run.spent_by(by)), is_success});
  }
  return attempts;
}

// The raw counts of the median successful run, as a tooltip of its cost.
TableCell with_calls(const Comparison& c, const Cell& cell, TableCell shown) {
  std::vector<std::pair<Real, std::size_t>> reached;
  for (const std::size_t index : cell.runs)
    if (const Real work = c.taken(c.runs[index], Measure::work, kTightest); work < kNever)
      reached.emplace_back(work, index);
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

// The cost of restarts on one cell; `rescued` counts cells that only restarts solve.
TableCell restart_cell(const Comparison& c, std::size_t p, std::size_t s, std::size_t& rescued) {
  const Cell& cell = c.cell(p, s);
  if (!cell.is_measured()) return cell.planned == 0 ? "" : cell.runs.empty() ? "missing" : "n/a";
  const std::vector<Attempt> attempts = attempts_of(c, cell);
  const auto successes = std::ranges::count_if(attempts, &Attempt::is_success);
  const Real expected = expected_running_time(attempts);
  TableCell shown{
      fmt::format("{} ({}/{})", reached_figure(expected), successes, attempts.size()),
      {{"expected", expected}, {"reached", Real(successes)}, {"n", Real(attempts.size())}}};
  rescued += expected < kNever && !cell.headline[kTightest].is_solved();
  if (expected < kNever && attempts.size() > 1) {
    const std::string key = c.problems[p].spec + " " + c.optimizers[s].label;
    const std::vector<Real> costs = simulated_restarts(attempts, key);
    const Real low = quantile(costs, 0.1), high = quantile(costs, 0.9);
    if (low < high) {
      shown.text = fmt::format("{} [{}–{}] ({}/{})", reached_figure(expected), figure(low),
                               figure(high), successes, attempts.size());
      shown.numbers.push_back({"low", low});
      shown.numbers.push_back({"high", high});
    }
  }
  return with_calls(c, cell, std::move(shown));
}

}  // namespace

Table restart_table(const Comparison& c) {
  Table table{
      .id = "restarts",
      .title = "Expected running time",
      .reading = "",
      .caption = fmt::format(
          "Cost to {} of a method that restarts until it reaches it, in {}: the total cost over "
          "the number of successes, and the middle 80 % of 1,000 simulated restarts resampled "
          "from the runs; ✗ if no run reached it. In parentheses: successful runs of all runs. "
          "The runs have different seeds. A restart therefore has another start and, if the "
          "problem has one, another target: the number is the cost of solving one of these "
          "instances, not a given one.",
          tau_name(c), cost_unit(c)),
      .columns = {"optimizer"},
      .rows = {}};
  std::size_t rescued = 0;
  const std::size_t problems = std::min(c.problems.size(), kMostProblems);
  for (std::size_t p = 0; p < problems; ++p) table.columns.push_back(problem_name(c.problems[p]));
  table.columns.push_back("failed");
  for (std::size_t s = 0; s < listed_optimizers(c, kMostTableRows); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (std::size_t p = 0; p < problems; ++p) row.push_back(restart_cell(c, p, s, rescued));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  columns_are_problems(table, problems);
  table.reading = fmt::format("In {}, only restarts reach it: the median run does not.",
                              counted(rescued, "cell"));
  return table;
}

}  // namespace isoline::reports
