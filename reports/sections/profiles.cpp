// The data profile as a table.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reports/read/ranking.h"
#include "reports/read/reached.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/words.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {
namespace {}  // namespace

Table data_profile_table(const Comparison& c) {
  constexpr std::array<int, 5> kWork = {10, 100, 1000, 10'000, 100'000};
  Table table{
      .id = "data-profile",
      .title = "Data profile",
      .reading = "",
      .caption = fmt::format(
          "Share of the {}s given to a method that its median run solves to {} within so many {}; "
          "unsolved, inapplicable and missing ones stay in n.",
          setting_noun(c), tau_name(c), cost_unit(c)),
      .columns = {"optimizer"},
      .rows = {}};
  for (const int work : kWork) table.columns.push_back(fmt::format("≤ {}", work));
  for (const std::string& column : std::vector<std::string>{"at all", n_column(c), "failed"})
    table.columns.push_back(column);
  const Measure by = cost_measure(c);
  Leading first;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s)};
    const std::size_t n = c.order.settings.size();
    for (const Real work : {Real(kWork[0]), Real(kWork[1]), Real(kWork[2]), Real(kWork[3]),
                            Real(kWork[4]), std::numeric_limits<Real>::max()}) {
      std::size_t within = 0;
      for (const std::size_t p : c.order.settings)
        within += in_units(by, c.cell(p, s).taken[by][kTightest].median) <= work;
      row.push_back(share_cell(within, n));
      if (work == kWork[2] && n > 0) first.offer(Real(within) / Real(n), optimizer_text(c, s));
    }
    row.push_back(count_cell(n));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading = fmt::format("The largest share within 1000 {}: {} ({}).", unit_name(by),
                              first.names(), percent(first.value));
  return table;
}

// The performance profile as a table.

namespace {

// The area of an optimizer's profile with its interval over problems, names drawn together.
Band area_band(const Comparison& c, const Costs& ratios, std::size_t s) {
  return band_over_names(c, column_of(ratios, s), "areas", [](Real ratio) {
    return std::vector<Real>{score_of(ratio, kProfileEnd)};
  });
}

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

}  // namespace isoline::reports
