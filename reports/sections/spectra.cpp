// The singular values of J along runs that kept them: who sees which part of the spectrum, and how
// learning changes the conditioning.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/read/sweeps.h"
#include "reports/sections/evidence.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kNone = std::numeric_limits<Real>::quiet_NaN();
constexpr Real kVisible = 1e-6;  // of the largest, the usual cut-off

// The run of the least seed that kept spectra.
struct Seen {
  std::size_t optimizer;
  const Record* record;

  const std::vector<Real>& first() const { return record->spectrum->sigma.front(); }
  const std::vector<Real>& last() const { return record->spectrum->sigma.back(); }
};

bool has_spectrum(const Record& record) {
  return record.spectrum && !record.spectrum->sigma.empty() &&
         !record.spectrum->sigma.front().empty();
}

// The best first.
std::vector<Seen> seen_on(const Comparison& c, std::size_t problem) {
  std::vector<Seen> all;
  for (const std::size_t s : ranking(c, problem))
    for (const std::size_t run : c.cell(problem, s).runs)
      if (has_spectrum(*c.runs[run].record)) {
        all.push_back({s, c.runs[run].record});
        break;
      }
  return all;
}

// σ₁/σ_r; nothing where the smallest is 0.
Real condition(const std::vector<Real>& sigma) {
  return sigma.back() > 0 ? sigma.front() / sigma.back() : kNone;
}

std::ptrdiff_t visible(const std::vector<Real>& sigma) {
  return std::ranges::count_if(sigma, [&](Real one) { return one > kVisible * sigma[0]; });
}

PlotSeries values(std::string name, const std::vector<Real>& sigma) {
  PlotSeries line{.optimizer = {}, .name = std::move(name)};
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    line.x.push_back(Real(i + 1));
    line.y.push_back(sigma[i] > 0 ? sigma[i] : kNone);
  }
  return line;
}

// Lines over both logarithms, still without any.
Plot empty_plot(const Comparison& c, std::size_t p, const std::string& id,
                const std::string& title) {
  return {.kind = Plot::Kind::lines,
          .id = fmt::format("plot-{}-{}", id, p),
          .title = fmt::format("{} on {}", title, problem_name(c.problems[p])),
          .reading = "",
          .caption = "",
          .is_log_x = true,
          .is_log_y = true};
}

Plot values_plot(const Comparison& c, std::size_t p, const std::vector<Seen>& seen) {
  Plot plot = empty_plot(c, p, "spectrum", "Singular values");
  plot.caption =
      "Of J = ∂y/∂θ over the batch of a step, all samples stacked and y unscaled, in the Euclidean "
      "norms of y and θ; the largest first, at the start and where each method ended; one run "
      "each, of the least seed.";
  plot.x_label = "number of the singular value";
  plot.y_label = "σ";
  plot.series.push_back(values("at the start", seen[0].first()));
  for (std::size_t i = 0; i < std::min(seen.size(), kMostRivals); ++i)
    plot.series.push_back(
        values(fmt::format("{}, iteration {}", optimizer_text(c, seen[i].optimizer),
                           seen[i].record->spectrum->iterations.back()),
               seen[i].last()));
  plot.reading =
      fmt::format("At the start {} of {} lie above 1e-6 of the largest; where {} ended, {}.",
                  visible(seen[0].first()), seen[0].first().size(),
                  optimizer_text(c, seen[0].optimizer), visible(seen[0].last()));
  return plot;
}

Plot conditions_plot(const Comparison& c, std::size_t p, const std::vector<Seen>& seen) {
  Plot plot = empty_plot(c, p, "conditioning", "Condition number");
  plot.caption =
      "In the spectral norm: the largest singular value of J over the smallest, along the same "
      "runs; a gap where the smallest is 0.";
  plot.x_label = "1 + iteration";
  plot.y_label = "σ₁ / σᵣ";
  for (std::size_t i = 0; i < std::min(seen.size(), kMostRivals); ++i) {
    const Spectrum& spectrum = *seen[i].record->spectrum;
    PlotSeries line{.optimizer = seen[i].optimizer, .name = optimizer_text(c, seen[i].optimizer)};
    for (std::size_t k = 0; k < spectrum.sigma.size(); ++k) {
      line.x.push_back(1 + Real(spectrum.iterations[k]));
      line.y.push_back(condition(spectrum.sigma[k]));
    }
    plot.series.push_back(std::move(line));
  }
  const Real first = condition(seen[0].first()), last = condition(seen[0].last());
  plot.reading = std::isnan(first) || std::isnan(last)
                     ? "The smallest singular value is 0 at the start or at the end."
                     : fmt::format("From {} at the start to {} where {} ended.", figure(first),
                                   figure(last), optimizer_text(c, seen[0].optimizer));
  return plot;
}

// First and last, a row each.
Table spectra_table(const Comparison& c, std::size_t p, const std::vector<Seen>& seen) {
  Table table{.id = fmt::format("spectrum-{}", p),
              .title = fmt::format("Spectra on {}", problem_name(c.problems[p])),
              .reading = "",
              .caption =
                  "The largest and the smallest singular value of J over the batch of a "
                  "step, their ratio, and how many lie above 1e-6 of the largest.",
              .columns = {"optimizer", "iteration", "σ₁", "σᵣ", "σ₁ / σᵣ", "above 1e-6"}};
  const auto add = [&](const Seen& one, const std::vector<Real>& sigma, std::int64_t iteration) {
    const Real ratio = condition(sigma);
    table.rows.push_back({optimizer_text(c, one.optimizer),
                          std::to_string(iteration),
                          {figure(sigma.front()), {{"largest", sigma.front()}}},
                          {figure(sigma.back()), {{"smallest", sigma.back()}}},
                          {std::isnan(ratio) ? "inf" : figure(ratio), {{"condition", ratio}}},
                          fmt::format("{} of {}", visible(sigma), sigma.size())});
    table.row_topics.push_back({.optimizer = one.optimizer, .problem = p});
  };
  for (const Seen& one : seen) {
    add(one, one.first(), one.record->spectrum->iterations.front());
    add(one, one.last(), one.record->spectrum->iterations.back());
  }
  return table;
}

bool is_drawable(const Seen& seen) {
  const auto is_seen = [](Real sigma) { return sigma > 0 && std::isfinite(sigma); };
  return std::ranges::any_of(seen.first(), is_seen) && std::ranges::any_of(seen.last(), is_seen);
}

}  // namespace

Section spectra_section(const Comparison& c) {
  Section section{.id = "spectra",
                  .title = "The spectrum of J",
                  .lead = "What a method over the spectrum of J sees, and what steps make of it.",
                  .otherwise = "No run kept singular values: isoline run --spectrum keeps them."};
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    std::vector<Seen> seen = seen_on(c, p);
    std::erase_if(seen, [](const Seen& one) { return !is_drawable(one); });
    if (seen.empty()) continue;
    section.plots.push_back(values_plot(c, p, seen));
    section.plots.push_back(conditions_plot(c, p, seen));
    section.tables.push_back(spectra_table(c, p, seen));
  }
  return section;
}

// Two options swept together, as heat maps: where the best stands, and how far around it is good.

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
