// Tables of costs: counts of oracle calls with their total cost, measured costs, expected running
// times with restarts, and the work of every optimizer on each problem.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/results/statistics.h"
#include "core/results/study.h"
#include "core/trace.h"
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

// With several workers, the forward solves that a method hands over together share rounds.

namespace {

bool has_rounds(const Comparison& c, std::size_t s) {
  return std::ranges::all_of(c.order.settings, [&](std::size_t p) {
    const Cell& cell = c.cell(p, s);
    return cell.is_measured() && std::ranges::all_of(cell.runs, [&](std::size_t row) {
             return !c.runs[row].record->curve.rounds.empty();
           });
  });
}

bool shares_rounds(const Comparison& c, std::size_t s) {
  return std::ranges::any_of(c.order.settings, [&](std::size_t p) {
    return std::ranges::any_of(c.cell(p, s).runs, [&](std::size_t row) {
      const Curve& curve = c.runs[row].record->curve;
      return std::ranges::any_of(curve.rounds, [&](const auto& column) {
        return column.second.back() < curve.work.back();
      });
    });
  });
}

// To the tightest tolerance, the median over runs.
Real median_rounds(const Comparison& c, std::size_t p, std::size_t s, std::int64_t workers) {
  const Cell& cell = c.cell(p, s);
  const auto rounds = [&](const Run& run) {
    const Real work = c.taken(run, Measure::work, kTightest);
    return work == kNever ? kNever : std::max<Real>(1, rounds_at(*run.record, work, workers));
  };
  return c.aggregate(cell.runs, rounds, cell.missing()).median;
}

}  // namespace

Table rounds_table(const Comparison& c) {
  std::vector<std::size_t> methods;
  for (const std::size_t s : c.order.methods)
    if (has_rounds(c, s)) methods.push_back(s);
  if (c.order.settings.empty() ||
      std::ranges::none_of(methods, [&](std::size_t s) { return shares_rounds(c, s); }))
    return {};
  Table table = worded_table("rounds", setting_noun(c), tau_name(c));
  std::vector<std::int64_t> workers(1, 1);
  workers.insert(workers.end(), kWorkers.begin(), kWorkers.end());
  std::vector<std::vector<Real>> ratios(workers.size() * methods.size());
  std::vector<Leading> first(workers.size());
  for (std::size_t w = 0; w < workers.size(); ++w) {
    table.columns.push_back(counted(static_cast<std::size_t>(workers[w]), "worker"));
    for (const std::size_t p : c.order.settings) {
      std::vector<Real> rounds;
      for (const std::size_t s : methods) rounds.push_back(median_rounds(c, p, s, workers[w]));
      const Real least = std::ranges::min(rounds);
      for (std::size_t i = 0; i < methods.size(); ++i)
        ratios[w * methods.size() + i].push_back(rounds[i] == kNever ? kNever : rounds[i] / least);
    }
  }
  for (const char* column : {"n", "failed"}) table.columns.emplace_back(column);
  for (std::size_t i = 0; i < std::min(methods.size(), kMostTableRows); ++i) {
    const std::size_t s = methods[i];
    std::vector<Real> calls;
    for (const std::size_t p : c.order.settings) calls.push_back(median_rounds(c, p, s, 1));
    std::vector<TableCell> row = {
        count_cell(calls.size() - static_cast<std::size_t>(std::ranges::count(calls, kNever)))};
    const Real median = median_of(calls);
    row.emplace_back(reached_figure(median), TableCell::Numbers{{"median", median}});
    for (std::size_t w = 0; w < workers.size(); ++w) {
      const Real ratio = median_of(ratios[w * methods.size() + i]);
      row.emplace_back(ratio == kNever ? reached_figure(ratio) : multiple(ratio),
                       TableCell::Numbers{{"median", ratio}});
      first[w].offer(1 / ratio, optimizer_text(c, s));
    }
    row.push_back(count_cell(calls.size()));
    row.push_back(failed_cell(c, s));
    add_row(table, c, s, std::move(row));
  }
  table.reading =
      words("rounds.reading", first.front().text(), workers.back(), first.back().text());
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
