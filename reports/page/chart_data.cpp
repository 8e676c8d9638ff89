// Numbers of the page's data.
#include "reports/page/chart_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <unordered_map>

#include "core/json.h"
#include "core/threads.h"
#include "reports/formats/escape.h"
#include "reports/page/contour.h"
#include "reports/page/fields_html.h"
#include "reports/page/kinds.h"
#include "reports/page/page.h"
#include "reports/read/curves.h"
#include "reports/read/ranking.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/origins.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string number(Real value) { return std::isfinite(value) ? figure(value) : "null"; }
std::string coarse(Real value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "null";
}

std::string indices(const std::vector<std::size_t>& all) {
  return list(all, [](std::size_t index) { return std::to_string(index); });
}

// Writes medians as short texts.

namespace {

std::string alphanumeric(std::uint64_t value) {
  constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuvwxyz";
  std::string text;
  for (; value > 0 || text.empty(); value /= kDigits.size())
    text.insert(text.begin(), kDigits[value % kDigits.size()]);
  return text;
}

// Twice a median of whole numbers is whole.
std::string work_code(Real work) {
  return alphanumeric(static_cast<std::uint64_t>(std::llround(2 * work)));
}

// The very digits that the tables print, as a whole number, and a capital for the power of ten: J
// is 0, I is −1. "0.0931" is 931 and F.
std::string digits_code(const std::string& text) {
  const std::size_t e = std::min(text.find('e'), text.size());
  int power = e < text.size() ? std::stoi(text.substr(e + 1)) : 0;
  std::string digits = text.substr(0, e);
  if (const std::size_t point = digits.find('.'); point != std::string::npos) {
    power -= static_cast<int>(digits.size() - point) - 1;
    digits.erase(point, 1);
  }
  if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return "";
  return alphanumeric(std::stoull(digits)) + static_cast<char>('J' + std::clamp(power, -9, 9));
}
std::string time_code(Real seconds) { return digits_code(milliseconds(seconds)); }

// Of costs, which are no whole numbers: a digit more than tables print.
std::string cost_code(Real cost) { return digits_code(fmt::format("{:.5g}", cost)); }

auto code_of(Measure by) {
  return by == Measure::time ? time_code : by == Measure::cost ? cost_code : work_code;
}

}  // namespace

std::string target_codes(const std::vector<Real>& medians, Measure by) {
  const auto code = code_of(by);
  std::string text;
  for (std::size_t j = 0; j < medians.size();) {
    const std::string one = code(medians[j]);
    std::size_t count = 1;
    while (j + count < medians.size() && code(medians[j + count]) == one) ++count;
    text += (j > 0 ? "," : "") + one + (count > 1 ? fmt::format("*{}", count) : "");
    j += count;
  }
  return text;
}

// What the page draws of one problem: medians, curves, contours and paths as compact JSON.

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

// The papers' figures in the page: captions as HTML, lines and pictures as data for the scripts.

namespace {

Json numbers(const std::vector<Real>& values) {
  Json list = Json::array();
  constexpr int kDigits = 5;
  for (const Real value : values)
    list.push_back(std::isfinite(value) ? Json(std::stod(fmt::format("{:.{}g}", value, kDigits)))
                                        : Json());
  return list;
}

// Greys from 0 at `low` to 255 at `high`, two hexadecimal digits a cell.
std::string greys(const std::vector<Real>& values, Real low, Real high) {
  std::string text;
  for (const Real value : values) {
    const Real share = high > low ? (value - low) / (high - low) : 0;
    text += fmt::format("{:02x}", std::lround(255 * std::clamp(share, 0.0, 1.0)));
  }
  return text;
}

// y* has its own scale; all that are x share that of x*, which comes last.
Json pictures_json(const std::vector<Picture>& pictures) {
  Json list = Json::array();
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto [low, high] = std::ranges::minmax((i == 0 ? pictures[0] : pictures.back()).values);
    list.push_back({{"title", pictures[i].title},
                    {"size", pictures[i].size},
                    {"low", numbers({low})[0]},
                    {"high", numbers({high})[0]},
                    {"greys", greys(pictures[i].values, low, high)}});
  }
  return list;
}

Json lines_json(const std::vector<FigureLine>& lines) {
  Json list = Json::array();
  for (const FigureLine& line : lines)
    list.push_back({{"s", line.optimizer},
                    {"x", numbers(line.x)},
                    {"y", numbers(line.y)},
                    {"low", numbers(line.low)},
                    {"high", numbers(line.high)}});
  return list;
}

Json published_json(const std::vector<PublishedMark>& marks) {
  Json list = Json::array();
  for (const PublishedMark& mark : marks)
    list.push_back({{"s", mark.optimizer},
                    {"name", mark.name},
                    {"x", mark.x},
                    {"y", mark.y},
                    {"low", numbers({mark.low})[0]},
                    {"high", numbers({mark.high})[0]}});
  return list;
}

std::string problem_attribute(const Comparison& c, const Figure& figure) {
  const auto at = std::ranges::find_if(c.problems, [&](const ProblemAxis& problem) {
    return shown_spec(problem.spec) == shown_spec(figure.problem);
  });
  return at == c.problems.end() ? "" : fmt::format(" data-p={}", at - c.problems.begin());
}

}  // namespace

std::string figures_html(const Document& document) {
  const Comparison& c = document.comparison;
  const std::vector<Figure>& all = document.figures;
  std::string html;
  for (std::size_t i = 0; i < all.size(); ++i)
    html += fmt::format(
        "<figure class=\"panel{}\" data-figure={}{}><figcaption><b>{}</b> <span "
        "class=formula>{}</span>"
        "<p class=reading>{}</p></figcaption></figure>\n",
        all[i].pictures.empty() ? "" : " wide", i, problem_attribute(c, all[i]),
        html_text(all[i].title), html_text(all[i].problem), html_text(all[i].reading));
  return html.empty() ? "<p class=lead>No problem of this report has figures of its own.</p>"
                      : "<div class=panels>" + html + "</div>";
}

std::string json_quoted(const std::string& text) { return json_text(Json(text)); }

std::string figures_json(const std::vector<Figure>& all) {
  Json list = Json::array();
  for (const Figure& figure : all)
    list.push_back({{"title", figure.title},
                    {"kind", figure.kind},
                    {"x_label", figure.x_label},
                    {"y_label", figure.y_label},
                    {"log_x", figure.is_log_x},
                    {"log_y", figure.is_log_y},
                    {"diagonal", figure.has_diagonal},
                    {"published", published_json(figure.published)},
                    {"paper", figure.of_the_paper},
                    {"lines", lines_json(figure.lines)},
                    {"pictures", pictures_json(figure.pictures)}});
  return json_text(list);
}

// What the scripts of the page choose from: names, standings to every target by every measure, and
// the problems' own data.

namespace {

// {"id": [optimizers, problems]}: what the cells that decide a claim are about.
std::string claims_about(const Document& document) {
  const Comparison& c = document.comparison;
  std::unordered_map<std::string_view, const Run*> by_cell;
  for (const Run& run : c.runs) by_cell.emplace(run.record->cell, &run);
  std::string text = "{";
  for (const Judgement& judgement : document.claims) {
    std::set<std::size_t> optimizers, problems;
    for (const std::string& cell : judgement.cells)
      if (const auto at = by_cell.find(cell); at != by_cell.end()) {
        optimizers.insert(at->second->optimizer);
        problems.insert(at->second->problem);
      }
    text += fmt::format("{}{}:[{},{}]", text.size() > 1 ? "," : "", json_quoted(judgement.id),
                        indices({optimizers.begin(), optimizers.end()}),
                        indices({problems.begin(), problems.end()}));
  }
  return text + "}";
}

// [optimizer, score, solved, best on, × least, runs that get there] of each, one after the other.
std::string places_json(const std::vector<Ranked>& places) {
  return list(places, [](const Ranked& place) {
    const Standing& standing = place.standing;
    return fmt::format("{},{:.4g},{},{},{},{}", place.optimizer, standing.score, standing.solved,
                       standing.wins, coarse(standing.typical), standing.reached);
  });
}

// By measure and target; 0 where they are those of the target before.
std::string standings_json(const Comparison& c, const Ladders& ladders) {
  const std::vector<Measure> measures = measures_of(c);
  const std::vector<std::size_t> targets = targets_of(c);
  const std::size_t n = targets.size();
  std::vector<std::string> all(measures.size() * n);
  share(all.size(), [&](std::size_t i) {
    all[i] = places_json(ladders.standings(measures[i / n], targets[i % n]));
  });
  std::string text = "[";
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_first = i % n == 0;
    text += i == 0 ? "[" : is_first ? "],[" : ",";
    text += !is_first && all[i] == all[i - 1] ? "0" : all[i];
  }
  return text + "]]";
}

// What does not change from target to target: [settings, runs, failed, score's interval].
std::string given_json(const Comparison& c, const std::vector<Interval>& intervals) {
  std::vector<std::size_t> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) all.push_back(s);
  return list(all, [&](std::size_t s) {
    const OptimizerAxis& axis = c.optimizers[s];
    return fmt::format("[{},{},{},{},{}]", axis.tightest().settings, axis.tightest().runs,
                       axis.failed, coarse(intervals[s].low), coarse(intervals[s].high));
  });
}

template <class Text>
std::string of_optimizers(const Comparison& c, Text text) {
  return list(c.optimizers, [&](const OptimizerAxis& axis) { return json_quoted(text(axis)); });
}

std::string axes_json(const Comparison& c) {
  const auto asks = [](const OptimizerAxis& axis) {
    return axis.sheet == nullptr ? std::string() : joined(axis.sheet->oracles);
  };
  const auto style = [](const OptimizerAxis& axis) {
    const LineStyle line = style_of(axis);
    return fmt::format("[\"{}\",\"{}\",{}]", kMathematics[line.kind], kDashes[line.dash],
                       line.marker);
  };
  return fmt::format(
      "\"optimizers\":{},\"labels\":{},\"methods\":{},\"kinds\":{},\"styles\":{},"
      "\"privileges\":{},\"marks\":{},\"asks\":{}",
      of_optimizers(c, [](const OptimizerAxis& axis) { return optimizer_name(axis); }),
      of_optimizers(c,
                    [](const OptimizerAxis& axis) {
                      return shown_spec(axis.label) + (axis.is_foreign ? " ‡" : "");
                    }),
      of_optimizers(c, [](const OptimizerAxis& axis) { return axis.method; }),
      of_optimizers(c, [](const OptimizerAxis& axis) { return kind_title(axis.mathematics()); }),
      list(c.optimizers, style),
      of_optimizers(c, [](const OptimizerAxis& axis) { return joined(axis.privileges); }),
      of_optimizers(c, marks_of), of_optimizers(c, asks));
}

// name, what is counted, its unit, whether medians are whole or halves, the least that counts.
std::string measures_json(const Comparison& c) {
  return list(measures_of(c), [](Measure by) {
    const bool is_count = by == Measure::work || by == Measure::iterations;
    return fmt::format(
        "{{\"name\":\"{}\",\"counted\":\"{}\",\"unit\":\"{}\",\"isCount\":{},\"least\":{}}}",
        name_of(by), counted_name(by), unit_name(by), is_count, by == Measure::time ? "1e-3" : "1");
  });
}

// No </script and no <!-- can stand in it.
std::string safe(const std::string& text) {
  std::string out;
  for (const char letter : text)
    if (letter == '<')
      out += "\\u003c";
    else
      out += letter;
  return out;
}

}  // namespace

std::string page_data(const Document& document, const std::vector<Interval>& intervals,
                      const AllFields& fields) {
  const Comparison& c = document.comparison;
  const Ladders ladders(c);
  std::string text = fmt::format(
      "{{\"by\":\"{}\",\"shownAtFirst\":{},\"shades\":{},\"measures\":{},\"isTimedTogether\":{},\"rungs\":{},\"targets\":{},{},\"given\":{},"
      "\"ranked\":{},\"common\":{},\"claims\":{},\"figures\":{},\"standings\":{},\"problems\":[",
      name_of(c.yardstick.by), kShownAtFirst, list(kShades, exact_figure), measures_json(c),
      c.is_any_timed_together,
      list(c.yardstick.tolerances,
           [](const Tolerance& tolerance) { return std::to_string(tolerance.rung); }),
      indices(targets_of(c)), axes_json(c), given_json(c, intervals), indices(c.order.methods),
      indices(c.order.settings), claims_about(document), figures_json(document.figures),
      standings_json(c, ladders));
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    text += (p > 0 ? "," : "") + problem_data(c, ladders, p, fields[p]);
  return safe(text + "]}");
}

}  // namespace isoline::reports
