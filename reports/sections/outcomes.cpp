// Tables of outcomes: performance profiles in figures, and what was returned beside what was seen.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/read/grounds.h"
#include "reports/read/orders.h"
#include "reports/read/reached.h"
#include "reports/sections/evidence.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/words.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {

// The area of an optimizer's profile with its interval over problems, names drawn together.
Band area_band(const Comparison& c, const Costs& ratios, std::size_t s) {
  return band_over_names(c, column_of(ratios, s), "areas", [](Real ratio) {
    return std::vector<Real>{score_of(ratio, kProfileEnd)};
  });
}

// Problems whose median run returns a point that meets the tolerance; a failed run returns none.
std::size_t returned(const Comparison& c, std::size_t s, std::size_t tolerance) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    std::vector<Real> unmet;
    for (const std::size_t index : c.cell(p, s).runs) {
      const Run& run = c.runs[index];
      const bool is_met =
          !is_failure(run.record->status) && returns(run, c.yardstick.tolerances[tolerance].tau);
      unmet.push_back(is_met ? 0 : kNever);
    }
    count += c.cell(p, s).is_measured() && median_of(unmet) < kNever;
  }
  return count;
}

// Those whose median run met it at the best point seen.
std::size_t seen(const Comparison& c, std::size_t s, std::size_t tolerance) {
  return static_cast<std::size_t>(std::ranges::count_if(c.cells, [&](const auto& row) {
    return row[s].is_measured() && row[s].headline[tolerance].is_solved();
  }));
}

// Methods that do not return what they have seen.
struct Losing {
  std::size_t methods = 0, most = 0;
  std::string worst;

  void add(std::size_t lost, const std::string& method) {
    ++methods;
    if (lost <= most) return;
    most = lost;
    worst = method;
  }
  std::string reading(const Comparison& c) const {
    const std::string tau = tau_name(c);
    if (methods == 0)
      return fmt::format("Every method shown returns a point within {} wherever it has seen one.",
                         tau);
    return fmt::format(
        "On some {} {} {} seen a point within {} and not returned it; on most, {}: {}.",
        setting_noun(c), counted(methods, "method"), methods == 1 ? "has" : "have", tau, most,
        worst);
  }
};

TableCell area_cell(Real area) { return {fmt::format("{:.3f}", area), {{"area", area}}}; }

TableCell interval_cell(Real low, Real high) {
  return {fmt::format("{:.3f}–{:.3f}", low, high), {{"low", low}, {"high", high}}};
}

}  // namespace

Table profile_table(const Comparison& c) {
  Table table{
      .id = "performance-profile",
      .title = "Performance profile",
      .reading = "",
      .caption = fmt::format(
          "Share of the {}s given to a method that its median run solves to {} within so many "
          "times the least {} (Dolan, Moré 2002). Area: under the profile over log2 of the factor "
          "up to 64, in closed form, with the 95 % bootstrap interval over problems (1,000 draws). "
          "Whether an order is more than chance is no matter of these intervals, since all methods "
          "share the problems: see the pairs.",
          setting_noun(c), tau_name(c), counted_name(c)),
      .columns = {"optimizer", "≤ 1×", "≤ 2×", "≤ 4×", "≤ 16×", "at all", "area", "interval",
                  n_column(c), "failed"},
      .rows = {}};
  Costs ratios;
  for (const auto& row : common_costs(c, kTightest)) ratios.push_back(cost_ratios(row));
  const Profile& profile = c.profiles[kTightest];
  Leading first;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    const std::size_t n = s < profile.solvers.size() ? profile.solvers[s].problems : 0;
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (const Real factor : {1.0, 2.0, 4.0, 16.0, std::numeric_limits<Real>::max()}) {
      const Real share = n == 0 ? 0 : profile.share(s, factor);
      row.push_back(share_cell(static_cast<std::size_t>(std::llround(share * Real(n))), n));
    }
    const Band band = area_band(c, ratios, s);
    const bool has_area = !band.low.empty();
    if (has_area) first.offer(band.value[0], optimizer_text(c, s));
    row.push_back(has_area ? area_cell(band.value[0]) : "");
    row.push_back(has_area ? interval_cell(band.low[0], band.high[0]) : "");
    row.push_back(count_cell(n));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading = first.count == 0
                      ? fmt::format("No method solves any {} to {}.", setting_noun(c), tau_name(c))
                      : fmt::format("The largest area, {:.3f}: {}.", first.value, first.names());
  return table;
}

Table returned_table(const Comparison& c) {
  Table table{
      .id = "returned",
      .title = "What was returned",
      .reading = "",
      .caption =
          "History and output: share of the settings given to a method whose median run meets the "
          "tolerance at the best point it ever evaluated (seen), and at the point it returned; and "
          "the digits of the loss gained there, the median over settings, no more than the target "
          "at which a run is stopped: what lies beyond is overshoot. A failed run returns nothing.",
      .columns = {"optimizer"},
      .rows = {}};
  for (const Tolerance& tolerance : c.yardstick.tolerances)
    for (const char* where : {"seen", "returned"})
      table.columns.push_back(fmt::format("{} {}", tolerance.name, where));
  for (const std::string& column :
       std::vector<std::string>{"digits seen", "digits returned", n_column(c), "failed"})
    table.columns.push_back(column);
  Losing losing;
  for (std::size_t s = 0; s < listed_optimizers(c, kMostTableRows); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s)};
    const std::size_t n = c.optimizers[s].planned;
    for (std::size_t t = 0; t < kTolerances.size(); ++t) {
      const std::size_t met = seen(c, s, t), kept = returned(c, s, t);
      row.push_back(share_cell(met, n));
      row.push_back(share_cell(kept, n));
      if (t == kTightest && kept < met) losing.add(met - kept, optimizer_text(c, s));
    }
    row.push_back(digits_cell(-median_of(lacking_digits(c, s, &Summary::best_loss))));
    row.push_back(digits_cell(-median_of(lacking_digits(c, s, &Summary::loss))));
    row.push_back(count_cell(n));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading = losing.reading(c);
  return table;
}

}  // namespace isoline::reports
