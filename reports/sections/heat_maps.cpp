// Two options swept together, as heat maps: where the best stands, and how far around it is good.
#include <fmt/format.h>

#include <algorithm>

#include "reports/read/sweeps.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostGrids = 12;

bool is_of_x(const Comparison& c, const SweepGrid& grid) {
  for (const auto& row : grid.runs)
    for (const auto& cell : row)
      if (!cell.empty()) return c.runs[cell[0]].aim == Aim::x;
  return false;
}

// At the end of a run; infinite where it failed or is not finite.
Real end_of(const Run& run, bool is_of_x) {
  const Summary& summary = run.record->summary;
  const Real value = is_of_x ? summary.x_error : summary.loss;
  return is_failure(run.record->status) || !std::isfinite(value) ? kNever : value;
}

// Medians over seeds, [row][column]; nothing where nothing was planned.
struct Medians {
  std::vector<std::vector<std::optional<Spread>>> of;
  Real least = kNever;
  std::size_t row = 0, column = 0;  // where the least stands
  std::size_t measured = 0, near = 0;
};

Medians medians_of(const Comparison& c, const SweepGrid& grid) {
  Medians all;
  const bool is_x = is_of_x(c, grid);
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    all.of.emplace_back(grid.columns.size());
    for (std::size_t k = 0; k < grid.columns.size(); ++k) {
      if (grid.runs[r][k].empty()) continue;
      std::vector<Real> ends;
      for (const std::size_t run : grid.runs[r][k]) ends.push_back(end_of(c.runs[run], is_x));
      const Spread spread = spread_of(ends);
      all.of[r][k] = spread;
      ++all.measured;
      if (spread.median < all.least) {
        all.least = spread.median;
        all.row = r;
        all.column = k;
      }
    }
  }
  for (const auto& row : all.of)
    for (const auto& cell : row) all.near += cell && cell->median <= 2 * all.least;
  return all;
}

std::string reading_of(const SweepGrid& grid, const Medians& medians) {
  if (medians.least == kNever) return "No setting ends at a finite value.";
  return fmt::format(
      "The least median, {}, stands at {} = {} and {} = {}; {} of {} {} within a factor of two of it.",
      figure(medians.least), grid.row, figure(grid.rows[medians.row]), grid.column,
      figure(grid.columns[medians.column]), medians.near, counted(medians.measured, "setting"),
      medians.near == 1 ? "lies" : "lie");
}

// An option of all of its runs that is not swept stands in the spec of the best.
std::string caption_of(const Comparison& c, const SweepGrid& grid, const Medians& medians) {
  std::size_t fewest = c.runs.size(), most = 0;
  for (const auto& row : grid.runs)
    for (const auto& cell : row) {
      if (cell.empty()) continue;
      fewest = std::min(fewest, cell.size());
      most = std::max(most, cell.size());
    }
  const std::string seeds = fewest == most ? counted(most, "seed")
                                           : fmt::format("{} to {}", fewest, counted(most, "seed"));
  const std::string length = grid.samples > 0 ? fmt::format("{} samples each", grid.samples)
                                              : fmt::format("{} iterations each", grid.iterations);
  std::string text = fmt::format(
      "{} at the end, median over {}, {}. The stronger the colour, the nearer to the least, in "
      "factors of two; ✗: not finite, or failed.",
      is_of_x(c, grid) ? "Error in x" : "Loss", seeds, length);
  if (medians.least == kNever) return text;
  const Request& best = c.runs[grid.runs[medians.row][medians.column][0]].record->request;
  return text + fmt::format(" The best: {} on {}.", shown_spec(best.optimizer.spec),
                            shown_spec(best.problem.spec));
}

TableCell cell_of(const std::optional<Spread>& spread, Real least) {
  if (!spread) return "";
  TableCell cell{reached_figure(spread->median),
                 {{"median", spread->median}, {"n", Real(spread->n)}}};
  if (spread->median < kNever) cell.shade = shade_of(spread->median, least);
  cell.is_best = spread->median == least && least < kNever;
  return cell;
}

Table heat_map(const Comparison& c, const SweepGrid& grid, std::size_t number) {
  const Medians medians = medians_of(c, grid);
  Table table{.id = fmt::format("sweep-{}", number),
              .title = fmt::format("{} on {}: {} × {}", grid.optimizer, grid.problem, grid.row,
                                   grid.column),
              .reading = reading_of(grid, medians),
              .caption = caption_of(c, grid, medians),
              .columns = {fmt::format("{} / {}", grid.row, grid.column)}};
  for (const Real value : grid.columns) table.columns.push_back(figure(value));
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    std::vector<TableCell> row = {figure(grid.rows[r])};
    for (const auto& cell : medians.of[r]) row.push_back(cell_of(cell, medians.least));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Section sweeps_section(const Comparison& c) {
  Section section{.id = "sweeps",
                  .title = "Two options at a time",
                  .lead =
                      "Settings of one method on one problem that differ in two options and "
                      "in nothing else.",
                  .otherwise = "No two options were swept together here."};
  const std::vector<SweepGrid> grids = sweep_grids(c);
  for (std::size_t i = 0; i < std::min(grids.size(), kMostGrids); ++i)
    section.tables.push_back(heat_map(c, grids[i], i + 1));
  if (grids.size() > kMostGrids)
    section.lead += fmt::format(" The largest {} of {} such grids.", kMostGrids, grids.size());
  return section;
}

}  // namespace isoline::reports
