// The error in x after a fixed number of forward solves.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/results/statistics.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::array<std::int64_t, 3> kSolves = {50, 100, 500};

// The least error in x over ‖x*‖ at kept points within so much work.
Real best_error(const Run& run, std::int64_t solves) {
  const Curve& curve = run.record->curve;
  Real best = kNever;
  for (std::size_t i = 0; i < curve.work.size() && curve.work[i] <= solves; ++i)
    if (std::isfinite(curve.x_error[i])) best = std::min(best, curve.x_error[i]);
  return best / *run.record->x_scale;
}

bool is_x_known(const Comparison& c, std::size_t p) {
  const auto knows = [&](const Cell& cell) {
    return !cell.is_measured() || c.runs[cell.runs[0]].record->x_scale.has_value();
  };
  return !c.problems[p].is_learned && std::ranges::all_of(c.cells[p], knows);
}

}  // namespace

Table fixed_budget_table(const Comparison& c) {
  std::vector<std::size_t> settings;
  for (const std::size_t p : c.order.settings)
    if (is_x_known(c, p)) settings.push_back(p);
  if (settings.empty()) return {};
  Table table = worded_table("fixed-budget", n_column(c));
  std::array<Leading, kSolves.size()> leaders;
  for (const std::size_t s : c.order.methods) {
    if (table.rows.size() == kMostTableRows) break;
    std::vector<TableCell> row;
    for (std::size_t i = 0; i < kSolves.size(); ++i) {
      std::vector<Real> errors;  // the median over seeds of each setting
      for (const std::size_t p : settings) {
        const Cell& cell = c.cell(p, s);
        const auto error = [&](const Run& run) { return best_error(run, kSolves[i]); };
        errors.push_back(cell.is_measured() ? c.aggregate(cell.runs, error, cell.missing()).median
                                            : kNever);
      }
      const Real error = median_of(std::move(errors));
      leaders[i].offer(1 / std::max(error, c.yardstick.tightest().tau),  // below it, all are equal
                       name_in_sentence(c.optimizers[s]));
      row.push_back({reached_figure(error), {{"error", error}}});
    }
    row.push_back(count_cell(settings.size()));
    row.push_back(failed_cell(c, s));
    add_row(table, c, s, std::move(row));
  }
  if (table.rows.size() > 1)
    table.reading =
        words("fixed-budget.reading", leaders[0].text(), leaders[1].text(), leaders[2].text());
  return table;
}

}  // namespace isoline::reports
