// Paths of a problem of two unknowns over isolines of its loss.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/records/sheet.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::vector<Real> even_steps(Real low, Real high, Real (*from)(Real)) {
  constexpr int kLevels = 13;
  std::vector<Real> levels;
  for (int i = 1; i <= kLevels; ++i) levels.push_back(from(low + (high - low) * i / (kLevels + 1)));
  return levels;
}

std::string levels_text(const Landscape& landscape) {
  if (landscape.spacing == "powers of two") return "at 2ⁱ for i = −5 … 7";
  if (landscape.spacing == "fifth root") return "in even steps of its fifth root";
  return "in even steps of its logarithm";
}

}  // namespace

std::vector<Real> contour_levels(const Landscape& landscape) {
  if (landscape.spacing == "powers of two")
    return even_steps(-6, 8, [](Real i) { return std::exp2(i); });
  Real low = INFINITY, high = 0;
  for (const Real loss : landscape.loss.values())
    if (std::isfinite(loss) && loss > 0) {
      low = std::min(low, loss);
      high = std::max(high, loss);
    }
  if (!(low < high)) return {};
  if (landscape.spacing == "fifth root")
    return even_steps(0, std::pow(high, 0.2), [](Real v) { return std::pow(v, 5); });
  constexpr Real kDecades = 1e-4;  // lower levels crowd around the minimum
  return even_steps(std::log(std::max(low, high * kDecades)), std::log(high),
                    [](Real v) { return std::exp(v); });
}

PlotSeries isoline(const Landscape& landscape, Real level) {
  const Grid& loss = landscape.loss;
  const auto& [left, right, low, high] = landscape.window;
  PlotSeries line;
  for (Index j = 0; j + 1 < loss.columns(); ++j)
    for (Index i = 0; i + 1 < loss.rows(); ++i) {
      const std::array<std::array<Index, 2>, 4> corners = {
          {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
      const auto loss_at = [&](std::size_t k) {
        return loss(corners[k % 4][0], corners[k % 4][1]);
      };
      const Real mean = (loss_at(0) + loss_at(1) + loss_at(2) + loss_at(3)) / 4;
      if (!std::isfinite(mean)) continue;
      std::vector<std::array<Real, 2>> crossings;
      for (std::size_t k = 0; k < 4; ++k) {
        const Real near = loss_at(k), far = loss_at(k + 1);
        if ((near < level) == (far < level)) continue;
        const Real t = (level - near) / (far - near);
        const auto at = [&](std::size_t axis, Real from, Real to, Index points) {
          const Real a = Real(corners[k][axis]), b = Real(corners[(k + 1) % 4][axis]);
          return from + (to - from) * (a + t * (b - a)) / Real(points - 1);
        };
        crossings.push_back({at(0, left, right, loss.rows()), at(1, low, high, loss.columns())});
      }
      // In a saddle, where all four sides are crossed, the mean of the corners decides which
      // corners are cut off.
      if (crossings.size() == 4 && (loss_at(0) < level) != (mean < level))
        std::swap(crossings[1], crossings[3]);
      for (std::size_t k = 0; k < crossings.size(); ++k) {
        if (k % 2 == 0 && !line.x.empty()) {
          line.x.push_back(NAN);
          line.y.push_back(NAN);
        }
        line.x.push_back(crossings[k][0]);
        line.y.push_back(crossings[k][1]);
      }
    }
  return line;
}

namespace {

using Rows = std::vector<std::vector<Real>>;

Drawing plane_drawing(const Comparison& c, std::size_t p, const std::vector<Path>& all,
                      const Landscape& landscape, const char* space, Rows Trajectory::*rows,
                      const std::vector<Real>& goal) {
  constexpr Real kMostStretch = 12;  // beyond it a valley would be a line
  const std::size_t points = std::clamp<std::size_t>(8000 / all.size(), 12, 120);
  const auto& [left, right, low, high] = landscape.window;
  const Real stretch = std::max((right - left) / (high - low), (high - low) / (right - left));
  Drawing out{
      .plot = {.kind = Plot::Kind::lines,
               .title = fmt::format("Paths in {} on {}", space, problem_name(c.problems[p])),
               .x_label = space + std::string("₁"),
               .y_label = space + std::string("₂")},
      .is_to_scale = stretch <= kMostStretch,
      .shown = shown_at_first(c, ranking(c, p)),
      .window = Window{left, right, low, high}};
  for (const Real level : contour_levels(landscape))
    out.ground.push_back(isoline(landscape, level));
  for (const Path& path : all) {
    PlotSeries& line = out.plot.series.emplace_back();
    const Rows& all_points = path.points->*rows;
    line.optimizer = path.optimizer;
    line.name = optimizer_name(c.optimizers[path.optimizer]);
    for (const std::size_t i : thinned(all_points.size(), points)) {
      const std::vector<Real>& point = all_points[i];
      line.x.push_back(point.size() == 2 ? point[0] : NAN);
      line.y.push_back(point.size() == 2 ? point[1] : NAN);
    }
  }
  const PlotSeries& first = out.plot.series.front();
  out.ends.push_back({{}, "start", {first.x.at(0)}, {first.y.at(0)}, {}, {}});
  if (goal.size() == 2) out.ends.push_back({{}, "goal", {goal[0]}, {goal[1]}, {}, {}});
  if (!out.is_to_scale)
    out.plot.caption =
        fmt::format("Not to scale: the scales of the axes differ by a factor of {:.3g}.", stretch);
  return out;
}

// Of the paths in x or in y; empty where fewer than two say anything.
std::string path_reading(const Comparison& c, std::vector<Path> all, Rows Trajectory::*rows) {
  const auto length = [rows](const Path& path) { return detour(path.points->*rows); };
  std::erase_if(all, [&](const Path& path) { return length(path) == kNever; });
  if (all.size() < 2) return "";
  const auto [straight, winding] = std::ranges::minmax(all, {}, length);
  constexpr Real kStraight = 1.0005;
  const Real least = length(straight);
  return fmt::format(
      "Shortest path: {}, {}. Longest path: {}, with {} the direct distance.",
      shown_spec(c.optimizers[straight.optimizer].label),
      least < kStraight ? "a straight line" : "with " + multiple(least) + " the direct distance",
      shown_spec(c.optimizers[winding.optimizer].label), multiple(length(winding)));
}

}  // namespace

// Paths as the paper draws them: short runs with a point a step, long ones as lines.
std::string planes_html(const Comparison& c, std::size_t p) {
  const Sheet* sheet = c.problems[p].sheet;
  const bool has_planes = sheet != nullptr && (sheet->landscape_x || sheet->landscape_y);
  const std::vector<Path> all = has_planes ? paths(c, p) : std::vector<Path>();
  if (all.empty()) return "";
  std::string html = "<div class=planes>";
  const auto add = [&](const std::optional<Landscape>& landscape, const char* space,
                       Rows Trajectory::*rows, const std::vector<Real>& goal, const char* title) {
    if (!landscape) return;
    const Drawing drawing = plane_drawing(c, p, all, *landscape, space, rows, goal);
    html += fmt::format("<figure class=plane><figcaption><b>{}</b> {} {}</figcaption>{}</figure>",
                        title, html_text(path_reading(c, all, rows)),
                        html_text(drawing.plot.caption), drawing_svg(drawing));
  };
  add(sheet->landscape_x, "x", &Trajectory::x, sheet->truth,
      "Paths in x, with contours of the loss.");
  add(sheet->landscape_y, "y", &Trajectory::y, sheet->target, "The same paths in y.");
  return html +
         fmt::format(
             "</div><p class=legend>Thin lines: contours of the loss, {}. The paths are those of "
             "the run with the lowest seed; points mark the steps of short runs. ○: start; ●: "
             "solution in x, target in y.</p>",
             levels_text(sheet->landscape_x ? *sheet->landscape_x : *sheet->landscape_y));
}

}  // namespace isoline::reports
