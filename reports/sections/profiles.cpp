// The data profile as a table.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "reports/read/grounds.h"
#include "reports/read/orders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/words.h"
#include "reports/statistics/runtimes.h"

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

}  // namespace isoline::reports
