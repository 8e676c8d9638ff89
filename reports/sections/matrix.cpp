// Problem by problem: what this data shows of each, and the work of every optimizer on it.
#include <fmt/format.h>

#include "reports/sections/measure_words.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
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
                  "never planned.",
                  counted_to_tau(c)),
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

}  // namespace isoline::reports
