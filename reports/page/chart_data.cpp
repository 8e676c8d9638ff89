// What the page draws of one problem: medians, curves, contours and paths as compact JSON.
#include "reports/page/chart_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/page/compact_json.h"
#include "reports/page/contour.h"
#include "reports/page/fields_html.h"
#include "reports/page/page.h"
#include "reports/page/target_codes.h"
#include "reports/read/curves.h"
#include "reports/read/ranking.h"
#include "reports/sections/origins.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// Points a line, so that all lines together stay within a few megabytes.
std::size_t points_per_curve(const Comparison& c) {
  constexpr std::size_t kAll = 40000, kLeast = 4, kMost = 64;
  const std::size_t curves = std::max<std::size_t>(1, c.problems.size() * c.optimizers.size());
  return std::clamp(kAll / curves, kLeast, kMost);
}
std::size_t points_per_path(std::size_t paths) {
  constexpr std::size_t kAll = 8000, kLeast = 12, kMost = 120;
  return std::clamp(kAll / std::max<std::size_t>(1, paths), kLeast, kMost);
}

// [s, iterations, work, cost, ms, gap, its least, its greatest, error in x, its least, its
// greatest]; what says nothing is empty: a range where seeds agree, an error where no truth is
// known.
std::string curve_json(const MedianCurve& curve, std::size_t optimizer) {
  const auto band = [](const std::vector<Real>& low, const std::vector<Real>& high) {
    if (low == high) return std::string("[],[]");
    return list(low, coarse) + "," + list(high, coarse);
  };
  const auto milliseconds = [](Real seconds) { return coarse(1e3 * seconds); };
  const bool is_cost_work = curve.cost == curve.work;
  std::string text = fmt::format(
      "[{},{},{},{},{},{},{}", optimizer, list(curve.iteration, number), list(curve.work, number),
      is_cost_work ? "[]" : list(curve.cost, coarse), list(curve.seconds, milliseconds),
      list(curve.gap, coarse), band(curve.gap_low, curve.gap_high));
  if (std::ranges::any_of(curve.x_error, [](Real error) { return std::isfinite(error); }))
    text += "," + list(curve.x_error, coarse) + "," + band(curve.x_error_low, curve.x_error_high);
  return text + "]";
}

// In the order of measures_of; 0 where they are those of the first.
std::string medians_json(const Comparison& c, const TargetMedians& medians) {
  const std::vector<std::size_t> targets = targets_of(c);
  const auto of = [&](Measure by) {
    std::vector<Real> taken;
    for (const std::size_t target : targets)
      if (const Real median = medians.at(by, target); median < kNever) taken.push_back(median);
    return taken;
  };
  const std::vector<Measure> measures = measures_of(c);
  return list(measures, [&](Measure by) {
    if (by != measures[0] && of(by) == of(measures[0])) return std::string("0");
    return '"' + target_codes(of(by), by) + '"';
  });
}

// [optimizer, targets reached by each run, [medians by measure], runs failed, runs missing]: what
// the page chooses from. The optimizer alone where the pair makes no sense.
std::string cell_json(const Comparison& c, const Ladders& ladders, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  if (!cell.runs.empty() && !cell.is_measured()) return fmt::format("[{}]", s);
  const TargetMedians& medians = ladders.at(p, s);
  const std::size_t missing = cell.planned - cell.runs.size();
  return fmt::format("[{},{},{}{}]", s, indices(medians.reached), medians_json(c, medians),
                     cell.failed + missing > 0 ? fmt::format(",{},{}", cell.failed, missing) : "");
}

std::string cells_json(const Comparison& c, const Ladders& ladders, std::size_t p) {
  std::vector<std::size_t> asked;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (c.cell(p, s).planned > 0) asked.push_back(s);
  return list(asked, [&](std::size_t s) { return cell_json(c, ladders, p, s); });
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

// {"optimizer": "3.8e-5, tuned"}, of those whose options a table of rates chose.
std::string origins_json(const Comparison& c, std::size_t p) {
  std::string text;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (const std::string origin = origin_text(c, p, s); !origin.empty())
      text += fmt::format("{}\"{}\":{}", text.empty() ? "" : ",", s, json_quoted(origin));
  return text.empty() ? "" : ",\"origins\":{" + text + "}";
}

// The norm of the solution, the median over runs, where an x is sought.
std::string goal_json(const Comparison& c, std::size_t p) {
  if (c.problems[p].aim != Aim::x) return "";
  std::vector<Real> scales;
  for (const Cell& cell : c.cells[p])
    for (const std::size_t run : cell.runs)
      if (const auto& scale = c.runs[run].record->x_scale) scales.push_back(*scale);
  return scales.empty() ? "" : fmt::format(",\"goal\":{}", number(median_of(scales)));
}

// What is learned, at equal work: [optimizer, error in x, its least, its greatest, loss, runs].
std::string learned_json(const Comparison& c, std::size_t p) {
  if (!c.problems[p].is_learned) return "";
  const EqualWork equal = equal_work(c, p);
  const auto row = [&](std::size_t s) {
    const AtEqualWork& at = *equal.methods[s];
    return fmt::format("[{},{},{},{},{},{}]", s, number(at.x_error.median), number(at.x_error.low),
                       number(at.x_error.high), number(at.loss.median), at.x_error.n);
  };
  return fmt::format(",\"learned\":{{\"work\":{},\"rows\":{}}}", number(equal.work),
                     list(equal.nearest_first(), row));
}

}  // namespace

std::vector<std::size_t> targets_of(const Comparison& c) {
  constexpr std::size_t kMostForAll = 5000;  // cells: some 200 bytes each for all targets
  std::vector<std::size_t> targets;
  if (c.problems.size() * c.optimizers.size() > kMostForAll) {
    for (const Tolerance& tolerance : c.yardstick.tolerances) targets.push_back(tolerance.rung);
    return targets;
  }
  for (std::size_t j = 0; j < kTargets; ++j) targets.push_back(j);
  return targets;
}

std::vector<Measure> measures_of(const Comparison& c) {
  std::vector<Measure> measures = {Measure::work, Measure::cost, Measure::time};
  if (c.yardstick.by == Measure::iterations) measures.push_back(Measure::iterations);
  return measures;
}

std::string problem_data(const Comparison& c, const Ladders& ladders, std::size_t p,
                         const std::optional<FoundFields>& fields) {
  const ProblemAxis& problem = c.problems[p];
  std::string text = fmt::format(
      "{{\"spec\":{},\"asked\":{},\"name\":{},\"group\":\"{}\",\"isOrdered\":{},\"cells\":{},"
      "\"curves\":{}",
      json_quoted(problem_name(problem)), json_quoted(problem.spec), json_quoted(problem.name),
      problem.group(), is_ordered(c, p), cells_json(c, ladders, p), curves_json(c, p));
  text += origins_json(c, p) + goal_json(c, p) + learned_json(c, p);
  if (fields) text += ",\"fields\":" + fields_json(*fields);
  const std::vector<Path> all = paths(c, p);
  if (const Sheet* sheet = problem.sheet; sheet != nullptr && !all.empty()) {
    if (sheet->landscape_x)
      text += ",\"x\":" + plane_json(*sheet->landscape_x, all, &Path::x, sheet->truth);
    if (sheet->landscape_y)
      text += ",\"y\":" + plane_json(*sheet->landscape_y, all, &Path::y, sheet->target);
  }
  return text + "}";
}

}  // namespace isoline::reports
