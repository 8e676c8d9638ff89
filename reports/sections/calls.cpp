// Tables of costs: raw counts of oracle calls with what they come to, and the prices themselves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/sections/evidence.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// What all runs of an optimizer that reached the tightest tolerance had asked by then.
struct Calls {
  std::array<Real, kOracles> counts{};
  Real work = 0, cost = 0;
  std::size_t reached = 0, runs = 0;
};

Calls calls_of(const Comparison& c, std::size_t s) {
  Calls calls;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const Cell& cell = c.cell(p, s);
    calls.runs += cell.planned;
    for (const std::size_t index : cell.runs) {
      const Run& run = c.runs[index];
      if (run.taken[Measure::work][kTightest] == kNever) continue;
      ++calls.reached;
      calls.work += run.taken[Measure::work][kTightest];
      calls.cost += run.taken[Measure::cost][kTightest];
      const OracleCounts counts = counts_at(*run.record, run.taken[Measure::work][kTightest]);
      for (std::size_t kind = 0; kind < kOracles; ++kind) calls.counts[kind] += Real(counts[kind]);
    }
  }
  return calls;
}

TableCell sum_cell(Real sum) { return {figure(sum), {{"sum", sum}}}; }

const MeasuredPrice* price_of(const Sheet& sheet, std::string_view oracle) {
  const auto at = std::ranges::find(sheet.prices->oracles, oracle, &MeasuredPrice::oracle);
  return at == sheet.prices->oracles.end() ? nullptr : &*at;
}

TableCell price_cell(const MeasuredPrice* price) {
  if (price == nullptr) return "";
  return {fmt::format("{} : {} [{}–{}]", price->declared, figure(price->price), figure(price->low),
                      figure(price->high)),
          {{"declared", Real(price->declared)},
           {"measured", price->price},
           {"low", price->low},
           {"high", price->high}}};
}

// Who is farthest from the declared price, by its logarithm.
struct Farthest {
  Real distance = 0;
  std::string words;

  void offer(const MeasuredPrice& price, const std::string& problem) {
    if (price.declared == 0 || price.price <= 0) return;
    const Real away = std::abs(std::log(price.price / Real(price.declared)));
    if (away <= distance) return;
    distance = away;
    words = fmt::format("{} of {}, declared {}, measured {}", price.oracle, problem, price.declared,
                        figure(price.price));
  }
};

std::string prices_reading(const std::vector<Real>& pullbacks, const Farthest& farthest) {
  if (pullbacks.empty())
    return "These results hold no measured prices: costs are at the declared ones.";
  const Spread spread = spread_of(pullbacks);
  return fmt::format(
      "A pullback, declared as 1, takes {:.3g} forward solves in the median of {} problems, from "
      "{:.3g} to {:.3g}; farthest from its declared price: {}.",
      spread.median, spread.n, spread.low, spread.high,
      farthest.words.empty() ? "none" : farthest.words);
}

}  // namespace

Table calls_table(const Comparison& c) {
  Table table{
      .id = "calls",
      .title = "Oracle calls",
      .reading = "",
      .caption =
          "Raw counts until 1e-6 was met, summed over the runs that met it; what they come to at "
          "declared prices (work) and in " +
          cost_unit(c) + " (cost). Of every single run: report.csv.",
      .columns = {"optimizer", "runs to 1e-6"},
      .rows = {}};
  std::vector<Calls> all;
  std::array<bool, kOracles> is_asked{};
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
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
  table.reading = fmt::format("All that is shown took {} declared forward solves, {} in {}.",
                              figure(work), figure(cost), cost_unit(c));
  return table;
}

Table prices_table(const Comparison& c) {
  Table table{
      .id = "prices",
      .title = "Prices",
      .reading = "",
      .caption =
          "What the first call of an oracle at a fresh point takes, in forward solves: declared : "
          "measured [middle 80 % of the rounds], in processor time, before the runs. Empty: not "
          "offered, or left out because it takes too long, and counted at its declared price.",
      .columns = {"problem", "forward, µs"},
      .rows = {}};
  std::vector<std::string_view> oracles;
  for (const std::string_view oracle : kOracleNames)
    if (oracle != "forward" && std::ranges::any_of(c.problems, [&](const ProblemAxis& problem) {
          return problem.prices.are_measured() && price_of(*problem.sheet, oracle) != nullptr;
        }))
      oracles.push_back(oracle);
  table.columns.insert(table.columns.end(), oracles.begin(), oracles.end());
  std::vector<Real> pullbacks;
  Farthest farthest;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const ProblemAxis& problem = c.problems[p];
    if (!problem.prices.are_measured()) continue;
    table.row_topics.push_back({.problem = p});
    const std::string name = shown_spec(problem.spec);
    const Real microseconds = 1e6 * problem.sheet->prices->forward_seconds;
    std::vector<TableCell> row = {name, {figure(microseconds), {{"microseconds", microseconds}}}};
    for (const std::string_view oracle : oracles)
      row.push_back(price_cell(price_of(*problem.sheet, oracle)));
    for (const MeasuredPrice& price : problem.sheet->prices->oracles) {
      farthest.offer(price, name);
      if (price.oracle == "pullback") pullbacks.push_back(price.price);
    }
    table.rows.push_back(std::move(row));
  }
  table.reading = prices_reading(pullbacks, farthest);
  return table;
}

}  // namespace isoline::reports
