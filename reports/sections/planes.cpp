// Paths of a problem of two unknowns over isolines of its loss.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "core/records/sheet.h"
#include "reports/sections/drawings.h"
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

namespace {

using Edge = std::pair<Index, Index>;  // two corners of a cell, the lower number first
using Segment = std::pair<Edge, Edge>;
using Point = std::array<Real, 2>;

// The segments joined at their ends, as lines apart by NaN.
PlotSeries joined(const std::vector<Segment>& segments, const std::map<Edge, Point>& crossings) {
  std::map<Edge, std::vector<std::size_t>> meeting;
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (const Edge& end : {segments[i].first, segments[i].second}) meeting[end].push_back(i);
  std::vector<bool> is_joined(segments.size());
  const auto next_after = [&](const Edge& end) -> std::optional<Edge> {
    for (const std::size_t i : meeting.at(end)) {
      if (is_joined[i]) continue;
      is_joined[i] = true;
      return segments[i].first == end ? segments[i].second : segments[i].first;
    }
    return std::nullopt;
  };
  PlotSeries line;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (is_joined[i]) continue;
    is_joined[i] = true;
    std::deque<Edge> chain = {segments[i].first, segments[i].second};
    while (const auto next = next_after(chain.back())) chain.push_back(*next);
    while (const auto next = next_after(chain.front())) chain.push_front(*next);
    if (!line.x.empty()) line.x.push_back(NAN), line.y.push_back(NAN);
    for (const Edge& end : chain) {
      line.x.push_back(crossings.at(end)[0]);
      line.y.push_back(crossings.at(end)[1]);
    }
  }
  return line;
}

}  // namespace

PlotSeries isoline(const Landscape& landscape, Real level) {
  const Grid& loss = landscape.loss;
  const auto& [left, right, low, high] = landscape.window;
  const Index rows = loss.rows(), columns = loss.columns();
  std::vector<Segment> segments;
  std::map<Edge, Point> crossings;
  for (Index j = 0; j + 1 < columns; ++j)
    for (Index i = 0; i + 1 < rows; ++i) {
      const std::array<Index, 4> corners = {i + rows * j, i + 1 + rows * j, i + 1 + rows * (j + 1),
                                            i + rows * (j + 1)};
      const auto loss_at = [&](Index corner) { return loss(corner % rows, corner / rows); };
      const Real mean =
          (loss_at(corners[0]) + loss_at(corners[1]) + loss_at(corners[2]) + loss_at(corners[3])) /
          4;
      if (!std::isfinite(mean)) continue;
      std::vector<Edge> crossed;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [a, b] = std::minmax(corners[k], corners[(k + 1) % 4]);
        const Real near = loss_at(a), far = loss_at(b);
        if ((near < level) == (far < level)) continue;
        const Real t = (level - near) / (far - near);
        const auto at = [t](Real from, Real to, Index first, Index last, Index points) {
          return from + (to - from) * (Real(first) + t * Real(last - first)) / Real(points - 1);
        };
        crossed.emplace_back(a, b);
        crossings[{a, b}] = {at(left, right, a % rows, b % rows, rows),
                             at(low, high, a / rows, b / rows, columns)};
      }
      // In a saddle, where all four sides are crossed, the mean of the corners decides which
      // corners are cut off.
      if (crossed.size() == 4 && (loss_at(corners[0]) < level) != (mean < level))
        std::swap(crossed[1], crossed[3]);
      for (std::size_t k = 0; k + 1 < crossed.size(); k += 2)
        segments.emplace_back(crossed[k], crossed[k + 1]);
    }
  return joined(segments, crossings);
}

namespace {

using Rows = std::vector<std::vector<Real>>;

Drawing plane_drawing(const Comparison& c, std::size_t p, const std::vector<Path>& all,
                      const Landscape& landscape, const char* space, Rows Trajectory::*rows,
                      const std::vector<Real>& goal) {
  constexpr Real kMostStretch = 12;  // beyond it a valley would be a line
  const auto& [left, right, low, high] = landscape.window;
  const Real stretch = std::max((right - left) / (high - low), (high - low) / (right - left));
  Drawing out{
      .plot = {.kind = Plot::Kind::lines,
               .title = fmt::format("Paths in {} on {}", space, problem_name(c.problems[p])),
               .x_label = space + std::string("₁"),
               .y_label = space + std::string("₂")},
      .is_to_scale = stretch <= kMostStretch,
      .shown = shown_at_first(c, ranking(c, p)),
      .window = Window{left, right, low, high},
      .rest = space};
  for (const Real level : contour_levels(landscape))
    out.ground.push_back(isoline(landscape, level));
  for (const Path& path : all) {
    PlotSeries& line = out.plot.series.emplace_back(line_of(c, path.optimizer));
    const Rows& all_points = path.points->*rows;
    for (const std::size_t i : path.kept) {
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

// A sentence on the paths in x or in y; empty where fewer than two say anything.
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

// In x and in y, as far as the problem has such contours and runs kept their paths.
std::vector<Plane> planes_of(const Comparison& c, std::size_t p) {
  std::vector<Plane> planes;
  if (!has_planes(c, p)) return planes;
  const Sheet* sheet = c.problems[p].sheet;
  const std::vector<Path> all = paths(c, p);
  const auto add = [&](const std::optional<Landscape>& landscape, const char* space,
                       Rows Trajectory::*rows, const std::vector<Real>& goal, const char* title) {
    if (landscape && !all.empty())
      planes.push_back({plane_drawing(c, p, all, *landscape, space, rows, goal), title,
                        path_reading(c, all, rows)});
  };
  add(sheet->landscape_x, "x", &Trajectory::x, sheet->truth,
      "Paths in x, with contours of the loss.");
  add(sheet->landscape_y, "y", &Trajectory::y, sheet->target, "The same paths in y.");
  return planes;
}

bool has_planes(const Comparison& c, std::size_t p) {
  const Sheet* sheet = c.problems[p].sheet;
  return sheet != nullptr && (sheet->landscape_x || sheet->landscape_y);
}

}  // namespace isoline::reports
