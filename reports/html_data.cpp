// What the charts of the page draw: curves, profiles, contours and paths as compact JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "reports/contour.h"
#include "reports/curves.h"
#include "reports/html.h"
#include "reports/text.h"

namespace isoline {
namespace {

// Points a line, so that all lines together stay within a few megabytes.
std::size_t points_per_curve(const Comparison& c) {
  constexpr std::size_t kAll = 60000, kLeast = 6, kMost = 64;
  const std::size_t curves = std::max<std::size_t>(1, c.problems.size() * c.optimizers.size());
  return std::clamp(kAll / curves, kLeast, kMost);
}
std::size_t points_per_path(std::size_t paths) {
  constexpr std::size_t kAll = 8000, kLeast = 12, kMost = 120;
  return std::clamp(kAll / std::max<std::size_t>(1, paths), kLeast, kMost);
}

std::string number(Real value) { return std::isfinite(value) ? figure(value) : "null"; }

std::string quoted(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

// "[a,b,c]" of whatever `item` writes.
template <class Range, class Item>
std::string list(const Range& range, Item item) {
  std::string text = "[";
  for (const auto& one : range) {
    if (text.size() > 1) text += ',';
    text += item(one);
  }
  return text + "]";
}

std::string curve_json(const MedianCurve& curve, std::size_t optimizer) {
  return fmt::format(
      "{{\"s\":{},\"iterations\":{},\"work\":{},\"seconds\":{},\"gap\":{},\"x_error\":{}}}",
      optimizer, list(curve.iteration, number), list(curve.work, number),
      list(curve.seconds, number), list(curve.gap, number), list(curve.x_error, number));
}

// In order of rank, so that the page can show the best by default.
std::string curves_json(const Comparison& c, std::size_t problem) {
  const std::size_t points = points_per_curve(c);
  return list(ranking(c, problem), [&](std::size_t s) {
    return curve_json(median_curve(c, c.cell(problem, s), points), s);
  });
}

std::string point(Real a, Real b) { return number(a) + "," + number(b); }

std::string contours_json(const Landscape& landscape) {
  const auto polyline = [](const Polyline& line) {
    return list(line, [](const Point& p) { return point(p.x1, p.x2); });
  };
  return list(contours(landscape), [&](const Contour& contour) {
    return fmt::format("{{\"level\":{},\"lines\":{}}}", number(contour.level),
                       list(contour.lines, polyline));
  });
}

using Rows = std::vector<std::vector<Real>>;

std::string path_json(const Rows& rows, std::size_t optimizer, std::size_t most) {
  const std::string points = list(thinned(rows.size(), most), [&](std::size_t i) {
    return rows[i].size() == 2 ? point(rows[i][0], rows[i][1]) : "null,null";
  });
  return fmt::format("{{\"s\":{},\"points\":{}}}", optimizer, points);
}

std::string plane_json(const Landscape& landscape, const std::vector<Path>& all, Rows Path::*rows,
                       const std::vector<Real>& goal) {
  const auto ranked_path = [&](const Path& path) {
    return path_json(path.*rows, path.index, points_per_path(all.size()));
  };
  return fmt::format("{{\"window\":{},\"contours\":{},\"paths\":{},\"goal\":{}}}",
                     list(landscape.window, number), contours_json(landscape),
                     list(all, ranked_path), list(goal, number));
}

std::string problem_json(const Comparison& c, std::size_t p) {
  const ProblemAxis& problem = c.problems[p];
  std::string text = fmt::format("{{\"spec\":{},\"curves\":{}", quoted(shown_spec(problem.spec)),
                                 curves_json(c, p));
  const std::vector<Path> all = paths(c, p);
  if (const Sheet* sheet = problem.sheet; sheet != nullptr && !all.empty()) {
    if (sheet->landscape_x)
      text += ",\"x\":" + plane_json(*sheet->landscape_x, all, &Path::x, sheet->truth);
    if (sheet->landscape_y)
      text += ",\"y\":" + plane_json(*sheet->landscape_y, all, &Path::y, sheet->target);
  }
  return text + "}";
}

// [[problems, ratio, …], …], one list an optimizer.
std::string profile_json(const Profile& profile) {
  return list(profile.solvers, [](const ProfileLine& line) {
    std::string text = fmt::format("[{}", line.problems);
    for (const Real ratio : line.ratios) text += "," + number(ratio);
    return text + "]";
  });
}

}  // namespace

std::string page_data(const Comparison& c, const std::vector<Figure>& figures) {
  std::string text = fmt::format(
      "{{\"optimizers\":{},\"profiles\":{},\"figures\":{},\"problems\":[",
      list(c.optimizers,
           [](const OptimizerAxis& optimizer) { return quoted(shown_spec(optimizer.label)); }),
      list(c.profiles, profile_json), figures_json(figures));
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (p > 0) text += ',';
    text += problem_json(c, p);
  }
  text += "]}";
  std::string safe;  // no </script and no <!-- can stand in it
  for (const char letter : text)
    if (letter == '<')
      safe += "\\u003c";
    else
      safe += letter;
  return safe;
}

}  // namespace isoline
