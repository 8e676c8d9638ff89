// The singular values of J along runs that kept them, and the change of the conditioning by
// learning.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

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
  std::string name;
  const Spectrum* spectrum;

  const std::vector<Real>& first() const { return spectrum->sigma.front(); }
  const std::vector<Real>& last() const { return spectrum->sigma.back(); }
};

bool is_drawable(const std::vector<Real>& sigma) {
  return std::ranges::any_of(sigma, [](Real one) { return one > 0 && std::isfinite(one); });
}

// The best first.
std::vector<Seen> seen_on(const Comparison& c, std::size_t problem) {
  std::vector<Seen> all;
  for (const std::size_t s : ranking(c, problem))
    for (const std::size_t run : c.cell(problem, s).runs) {
      const auto& spectrum = c.runs[run].record->spectrum;
      if (!spectrum || spectrum->sigma.empty() || spectrum->sigma.front().empty()) continue;
      if (is_drawable(spectrum->sigma.front()) && is_drawable(spectrum->sigma.back()))
        all.push_back({s, optimizer_text(c, s), &*spectrum});
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

Plot values_plot(Plot plot, const std::vector<Seen>& seen) {
  plot.caption =
      "Singular values of J = ∂y/∂θ over the batch of a step, all samples stacked and y unscaled, "
      "in the Euclidean norms of y and θ; the largest first, at the start and at the end of each "
      "method; one run each, of the least seed.";
  plot.x_label = "number of the singular value";
  plot.y_label = "σ";
  plot.series.push_back(values("at the start", seen[0].first()));
  for (const Seen& one : std::span(seen).first(std::min(seen.size(), kMostRivals)))
    plot.series.push_back(values(
        fmt::format("{}, iteration {}", one.name, one.spectrum->iterations.back()), one.last()));
  plot.reading = fmt::format(
      "At the start {} of {} lie above 1e-6 of the largest; where {} ended, {}.",
      visible(seen[0].first()), seen[0].first().size(), seen[0].name, visible(seen[0].last()));
  return plot;
}

Plot conditions_plot(Plot plot, const std::vector<Seen>& seen) {
  plot.caption =
      "In the spectral norm: the largest singular value of J over the smallest, along the same "
      "runs; a gap where the smallest is 0.";
  plot.x_label = "1 + iteration";
  plot.y_label = "σ₁ / σᵣ";
  for (const Seen& one : std::span(seen).first(std::min(seen.size(), kMostRivals))) {
    PlotSeries& line =
        plot.series.emplace_back(PlotSeries{one.optimizer, one.name, {}, {}, {}, {}});
    for (std::size_t k = 0; k < one.spectrum->sigma.size(); ++k) {
      line.x.push_back(1 + Real(one.spectrum->iterations[k]));
      line.y.push_back(condition(one.spectrum->sigma[k]));
    }
  }
  const Real first = condition(seen[0].first()), last = condition(seen[0].last());
  plot.reading = std::isnan(first) || std::isnan(last)
                     ? "The smallest singular value is 0 at the start or at the end."
                     : fmt::format("From {} at the start to {} where {} ended.", figure(first),
                                   figure(last), seen[0].name);
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
  for (const Seen& one : seen)
    for (const bool is_last : {false, true}) {
      const std::vector<Real>& sigma = is_last ? one.last() : one.first();
      const auto& iterations = one.spectrum->iterations;
      const Real ratio = condition(sigma);
      table.rows.push_back({one.name,
                            std::to_string(is_last ? iterations.back() : iterations.front()),
                            {figure(sigma.front()), {{"largest", sigma.front()}}},
                            {figure(sigma.back()), {{"smallest", sigma.back()}}},
                            {std::isnan(ratio) ? "inf" : figure(ratio), {{"condition", ratio}}},
                            fmt::format("{} of {}", visible(sigma), sigma.size())});
      table.row_topics.push_back({.optimizer = one.optimizer, .problem = p});
    }
  return table;
}

}  // namespace

Section spectra_section(const Comparison& c) {
  Section section{.id = "spectra",
                  .title = "The spectrum of J",
                  .lead =
                      "The spectrum of J, which spectral methods filter, and its change along "
                      "the runs.",
                  .otherwise = "No run kept singular values: isoline run --spectrum keeps them."};
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const std::vector<Seen> seen = seen_on(c, p);
    if (seen.empty()) continue;
    const auto plot = [&](const char* id, const char* title) {
      return Plot{.kind = Plot::Kind::lines,
                  .id = fmt::format("plot-{}-{}", id, p),
                  .title = fmt::format("{} on {}", title, problem_name(c.problems[p])),
                  .is_log_x = true,
                  .is_log_y = true};
    };
    section.plots.push_back(values_plot(plot("spectrum", "Singular values"), seen));
    section.plots.push_back(conditions_plot(plot("conditioning", "Condition number"), seen));
    section.tables.push_back(spectra_table(c, p, seen));
  }
  return section;
}

// Two options swept together, as heat maps: where the best stands, and how far around it is good.

namespace {

constexpr std::size_t kMostGrids = 12;

// Medians over seeds, [row][column]; nothing where nothing was planned.
struct Medians {
  std::vector<std::vector<std::optional<Spread>>> of;
  Real least = kNever;
  std::size_t row = 0, column = 0;  // where the least stands
  std::size_t measured = 0, near = 0;
  std::size_t fewest = 0, most = 0;  // seeds
  bool is_of_x = false;              // errors in x, else losses
  std::string best;                  // its optimizer and problem
};

// At the end of a run; infinite where it failed or is not finite.
Real end_of(const Run& run, bool is_of_x) {
  const Summary& summary = run.record->summary;
  const Real value = is_of_x ? summary.x_error : summary.loss;
  return is_failure(run.record->status) || !std::isfinite(value) ? kNever : value;
}

Medians medians_of(const Comparison& c, const SweepGrid& grid) {
  Medians all{.fewest = c.runs.size()};
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    all.of.emplace_back(grid.columns.size());
    for (std::size_t k = 0; k < grid.columns.size(); ++k) {
      const std::vector<std::size_t>& runs = grid.runs[r][k];
      if (runs.empty()) continue;
      if (all.measured++ == 0) all.is_of_x = c.runs[runs[0]].aim == Aim::x;
      all.fewest = std::min(all.fewest, runs.size());
      all.most = std::max(all.most, runs.size());
      std::vector<Real> ends;
      for (const std::size_t run : runs) ends.push_back(end_of(c.runs[run], all.is_of_x));
      const Spread& spread = all.of[r][k].emplace(spread_of(std::move(ends)));
      if (!(spread.median < all.least)) continue;
      const Request& request = c.runs[runs[0]].record->request;
      std::tie(all.least, all.row, all.column) = std::tuple{spread.median, r, k};
      all.best = shown_spec(request.optimizer.spec) + " on " + shown_spec(request.problem.spec);
    }
  }
  for (const auto& row : all.of)
    for (const auto& cell : row) all.near += cell && cell->median <= 2 * all.least;
  return all;
}

std::string reading_of(const SweepGrid& grid, const Medians& medians) {
  if (medians.least == kNever) return "No setting ends at a finite value.";
  return fmt::format(
      "The least median, {}, is at {} = {} and {} = {}; {} of {} {} within a factor of two of it.",
      figure(medians.least), grid.row, figure(grid.rows[medians.row]), grid.column,
      figure(grid.columns[medians.column]), medians.near, counted(medians.measured, "setting"),
      medians.near == 1 ? "lies" : "lie");
}

// An option of all of its runs that is not swept stands in the spec of the best.
std::string caption_of(const SweepGrid& grid, const Medians& medians) {
  return fmt::format(
      "{} at the end, median over {}{}, {} each. A stronger colour is nearer to the least, in "
      "factors of two; ✗: not finite, or failed.{}",
      medians.is_of_x ? "Error in x" : "Loss",
      medians.fewest == medians.most ? "" : fmt::format("{} to ", medians.fewest),
      counted(medians.most, "seed"),
      grid.samples > 0 ? fmt::format("{} samples", grid.samples)
                       : fmt::format("{} iterations", grid.iterations),
      medians.best.empty() ? "" : fmt::format(" The best: {}.", medians.best));
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
              .caption = caption_of(grid, medians),
              .columns = {fmt::format("{} / {}", grid.row, grid.column)}};
  for (const Real value : grid.columns) table.columns.push_back(figure(value));
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row.push_back(figure(grid.rows[r]));
    for (const auto& cell : medians.of[r]) row.push_back(cell_of(cell, medians.least));
  }
  return table;
}

}  // namespace

Section sweeps_section(const Comparison& c) {
  Section section{.id = "sweeps",
                  .title = "Two options at a time",
                  .lead = "Settings of one method on one problem that differ in two options only.",
                  .otherwise = "No two options were varied together in these runs."};
  const std::vector<SweepGrid> grids = sweep_grids(c);
  for (std::size_t i = 0; i < std::min(grids.size(), kMostGrids); ++i)
    section.tables.push_back(heat_map(c, grids[i], i + 1));
  if (grids.size() > kMostGrids)
    section.lead += fmt::format(" The largest {} of {} such grids.", kMostGrids, grids.size());
  return section;
}

}  // namespace isoline::reports
