// What the charts of the page draw: curves, profiles, contours and paths as compact JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <unordered_map>

#include "reports/page/contour.h"
#include "reports/page/page.h"
#include "reports/page/target_codes.h"
#include "reports/read/curves.h"
#include "reports/read/reached.h"
#include "reports/sections/measure_words.h"
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

std::string number(Real value) { return std::isfinite(value) ? figure(value) : "null"; }
std::string coarse(Real value) {  // three digits: enough for a curve
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "null";
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

// [s, iterations, work, seconds, gap, its least, its greatest, error in x, its least, its
// greatest]; what says nothing is empty: a range where seeds agree, an error where no truth is
// known.
std::string curve_json(const MedianCurve& curve, std::size_t optimizer) {
  const auto band = [](const std::vector<Real>& low, const std::vector<Real>& high) {
    if (low == high) return std::string("[],[]");
    return list(low, coarse) + "," + list(high, coarse);
  };
  std::string text = fmt::format("[{},{},{},{},{},{}", optimizer, list(curve.iteration, number),
                                 list(curve.work, number), list(curve.seconds, coarse),
                                 list(curve.gap, coarse), band(curve.gap_low, curve.gap_high));
  if (std::ranges::any_of(curve.x_error, [](Real error) { return std::isfinite(error); }))
    text += "," + list(curve.x_error, coarse) + "," + band(curve.x_error_low, curve.x_error_high);
  return text + "]";
}

// [optimizer, targets reached by each run, work, time, runs failed, runs missing]: tables and
// profiles of the page are made of it. The optimizer alone where the pair makes no sense.
std::string cell_json(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  if (!cell.runs.empty() && !cell.is_measured()) return fmt::format("[{}]", s);
  const TargetMedians medians = target_medians(c, cell);
  const std::size_t missing = cell.planned - cell.runs.size();
  return fmt::format("[{},{},\"{}\",\"{}\"{}]", s,
                     list(medians.reached, [](std::size_t n) { return std::to_string(n); }),
                     target_codes(medians.counted, c.yardstick.by),
                     target_codes(medians.seconds, Measure::time),
                     cell.failed + missing > 0 ? fmt::format(",{},{}", cell.failed, missing) : "");
}

std::string cells_json(const Comparison& c, std::size_t p) {
  std::vector<std::size_t> asked;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (c.cell(p, s).planned > 0) asked.push_back(s);
  return list(asked, [&](std::size_t s) { return cell_json(c, p, s); });
}

// In order of rank, so that the page can show the best by default.
std::string curves_json(const Comparison& c, std::size_t problem) {
  const std::size_t points = points_per_curve(c);
  return list(ranking(c, problem), [&](std::size_t s) {
    return curve_json(median_curve(c, c.cell(problem, s), points), s);
  });
}

std::string indices_json(const std::vector<std::size_t>& all) {
  return list(all, [](std::size_t index) { return std::to_string(index); });
}

// Who is compared with whom, and on what; and how those are that stand apart.
std::string orders_json(const Comparison& c) {
  const auto placed_json = [](const Placed& placed) {
    return fmt::format("{{\"s\":{},\"settings\":{},\"methods\":{}}}", placed.optimizer,
                       indices_json(placed.among.settings), indices_json(placed.among.methods));
  };
  return fmt::format("{{\"settings\":{},\"methods\":{},\"apart\":{}}}",
                     indices_json(c.order.settings), indices_json(c.order.methods),
                     list(c.apart, placed_json));
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

std::string problem_json(const Comparison& c, std::size_t p) {
  const ProblemAxis& problem = c.problems[p];
  std::string text =
      fmt::format("{{\"spec\":{},\"asked\":{},\"name\":{},\"cells\":{},\"curves\":{}",
                  json_quoted(shown_spec(problem.spec)), json_quoted(problem.spec),
                  json_quoted(problem.name), cells_json(c, p), curves_json(c, p));
  text += origins_json(c, p) + goal_json(c, p);
  const std::vector<Path> all = paths(c, p);
  if (const Sheet* sheet = problem.sheet; sheet != nullptr && !all.empty()) {
    if (sheet->landscape_x)
      text += ",\"x\":" + plane_json(*sheet->landscape_x, all, &Path::x, sheet->truth);
    if (sheet->landscape_y)
      text += ",\"y\":" + plane_json(*sheet->landscape_y, all, &Path::y, sheet->target);
  }
  return text + "}";
}

// {"id": [optimizers, problems]}: what the cells that decide a claim are about.
std::string claims_about(const Document& document) {
  const Comparison& c = document.comparison;
  std::unordered_map<std::string_view, const Run*> by_cell;
  for (const Run& run : c.runs) by_cell.emplace(run.record->cell, &run);
  const auto indices = [](const std::set<std::size_t>& all) {
    return list(all, [](std::size_t index) { return std::to_string(index); });
  };
  std::string text = "{";
  for (const Judgement& judgement : document.claims) {
    std::set<std::size_t> optimizers, problems;
    for (const std::string& cell : judgement.cells)
      if (const auto at = by_cell.find(cell); at != by_cell.end()) {
        optimizers.insert(at->second->optimizer);
        problems.insert(at->second->problem);
      }
    text += fmt::format("{}{}:[{},{}]", text.size() > 1 ? "," : "", json_quoted(judgement.id),
                        indices(optimizers), indices(problems));
  }
  return text + "}";
}

}  // namespace

std::string page_data(const Document& document) {
  const Comparison& c = document.comparison;
  std::string text = fmt::format(
      "{{\"by\":\"{}\",\"unit\":\"{}\",\"counted\":\"{}\",\"mark\":\"{}\",\"rungs\":{},"
      "\"optimizers\":{},\"methods\":{},\"families\":{},\"privileges\":{},\"claims\":{},"
      "\"order\":{},\"figures\":{},\"problems\":[",
      name_of(c.yardstick.by), unit_name(c), counted_name(c),
      c.yardstick.by == Measure::time && c.is_any_timed_together ? "≈" : "",
      list(c.yardstick.tolerances,
           [](const Tolerance& tolerance) { return std::to_string(tolerance.rung); }),
      list(c.optimizers,
           [](const OptimizerAxis& optimizer) { return json_quoted(shown_spec(optimizer.label)); }),
      list(c.optimizers,
           [](const OptimizerAxis& optimizer) { return json_quoted(optimizer.method); }),
      list(c.optimizers,
           [](const OptimizerAxis& optimizer) {
             return json_quoted(family_title(optimizer.family()));
           }),
      list(
          c.optimizers,
          [](const OptimizerAxis& optimizer) { return json_quoted(joined(optimizer.privileges)); }),
      claims_about(document), orders_json(c), figures_json(document.figures));
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

}  // namespace isoline::reports
