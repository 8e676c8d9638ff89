// The drawings of a report: curves of each problem, figures of papers, plots of sections and
// claims.
#include "reports/sections/drawings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "reports/sections/words.h"

namespace isoline::reports {

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

bool is_large(const Comparison& c) {
  constexpr std::size_t kMost = 2500;  // cells
  return c.problems.size() * c.optimizers.size() > kMost;
}

std::vector<Measure> measures_of(const Comparison& c) {
  std::vector<Measure> measures = {Measure::work, Measure::cost, Measure::time};
  if (c.yardstick.by == Measure::iterations) measures.push_back(Measure::iterations);
  return measures;
}

Look look_of(std::string_view method) {
  constexpr std::array<std::string_view, 6> kDashes = {"none",    "7 3",  "2 3",
                                                       "9 3 2 3", "14 4", "9 3 2 3 2 3"};
  constexpr std::string_view kMarkers = "os^vDPX<|";
  constexpr std::array<std::string_view, kMarkers.size()> kShapes = {
      "m-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0-7 0z",
      "m-3-3h6v6h-6z",
      "m0-4l4 7h-8z",
      "m0 4l4-7h-8z",
      "m0-4.4l4.4 4.4-4.4 4.4-4.4-4.4z",
      "m-1.4-4.2h2.8v2.8h2.8v2.8h-2.8v2.8h-2.8v-2.8h-2.8v-2.8h2.8z",
      "m0-1.9l2.3-2.3 1.9 1.9-2.3 2.3 2.3 2.3-1.9 1.9-2.3-2.3-2.3 2.3-1.9-1.9 2.3-2.3-2.3-2.3 1.9-1.9z",
      "m-4 0l7-4v8z",
      "m-1.2-4.4h2.4v8.8h-2.4z"};
  // FNV-1a (Fowler, Noll, Vo), from a start with which no two of our methods of a kind have both
  // alike.
  constexpr std::uint32_t kStart = 4407, kPrime = 0x01000193;
  std::uint32_t hash = kStart;
  for (const char letter : method) hash = (hash ^ static_cast<unsigned char>(letter)) * kPrime;
  hash ^= hash >> 16;
  const std::size_t mark = hash / kDashes.size() % kMarkers.size();
  return {kDashes[hash % kDashes.size()], kMarkers[mark], kShapes[mark]};
}

PlotSeries line_of(const Comparison& c, std::size_t s) {
  PlotSeries line{.optimizer = s, .name = optimizer_name(c.optimizers[s])};
  line.method = c.optimizers[s].method;
  return line;
}

bool is_hidden(const Drawing& drawing, const PlotSeries& line) {
  return line.optimizer && drawing.shown && !drawing.shown->contains(*line.optimizer);
}

Plot shown_lines(const Drawing& drawing) {
  Plot shown = drawing.plot;
  std::erase_if(shown.series, [&](const PlotSeries& line) { return is_hidden(drawing, line); });
  return shown.series.empty() ? drawing.plot : shown;
}

Window window_of(const Drawing& drawing) {
  if (drawing.window) return *drawing.window;
  const Plot& plot = drawing.plot;
  if (plot.kind == Plot::Kind::steps)
    return {plot.series[0].x.front(), plot.series[0].x.back(), 0, 1};
  Window window = window_of(shown_lines(drawing));
  constexpr Real kBeside = 0.03;  // so that the frame cuts no point
  if (std::ranges::any_of(plot.series, &PlotSeries::are_points)) {
    const Real wide = kBeside * (window.x_high - window.x_low),
               high = kBeside * (window.y_high - window.y_low);
    if (!plot.is_log_x)
      window = {window.x_low - wide, window.x_high + wide, window.y_low, window.y_high};
    if (!plot.is_log_y)
      window = {window.x_low, window.x_high, window.y_low - high, window.y_high + high};
  }
  return window;
}

Drawing drawing_of(const Plot& plot) {
  const bool is_steps = plot.kind == Plot::Kind::steps;
  Drawing out{.plot = plot, .join = is_steps ? Join::steps : Join::straight, .has_names = is_steps};
  std::set<std::size_t> first;
  for (const PlotSeries& line : plot.series)
    if (line.optimizer && first.size() < kMostLines) first.insert(*line.optimizer);
  if (!first.empty()) out.shown = std::move(first);
  return out;
}

std::set<std::size_t> shown_at_first(const Comparison& c, const std::vector<std::size_t>& ranking) {
  std::set<std::size_t> shown;
  std::set<std::string> kinds;
  for (std::size_t i = 0; i < ranking.size() && shown.size() < kMostShown; ++i)
    if (kinds.insert(c.optimizers[ranking[i]].mathematics()).second || i == 1)
      shown.insert(ranking[i]);
  return shown;
}

namespace {

// Points a line, so that all lines together stay within a few megabytes.
std::size_t points_per_curve(const Comparison& c) {
  constexpr std::size_t kAll = 40000, kLeast = 4, kMost = 64;
  const std::size_t curves = std::max<std::size_t>(1, c.problems.size() * c.optimizers.size());
  return std::clamp(kAll / curves, kLeast, kMost);
}

// --- curves

using Column = std::vector<Real>;

struct Vertical {
  const char *name, *label;
  Column MedianCurve::*middle, MedianCurve::*low, MedianCurve::*high;
};
constexpr Vertical kVerticals[] = {
    {"gap", "relative loss gap", &MedianCurve::gap, &MedianCurve::gap_low, &MedianCurve::gap_high},
    {"x_error", "error in x", &MedianCurve::x_error, &MedianCurve::x_error_low,
     &MedianCurve::x_error_high}};

constexpr Real kLowest = 1e-12;  // of a gap or an error: below lies rounding
constexpr Real kHighest = 1e3;   // of a gap: a run that diverges would flatten all others

Column taken_along(const MedianCurve& curve, Measure by) {
  if (by == Measure::work) return curve.work;
  if (by == Measure::cost) return curve.cost;
  if (by == Measure::iterations) return curve.iteration;
  Column milliseconds;
  for (const Real seconds : curve.seconds) milliseconds.push_back(1e3 * seconds);
  return milliseconds;
}

PlotSeries points_along(const MedianCurve& curve, const Vertical& vertical, Measure by) {
  PlotSeries line;
  const Column taken = taken_along(curve, by);
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const Real y = (curve.*vertical.middle)[i];
    if (!std::isfinite(taken[i]) || !std::isfinite(y)) continue;
    line.x.push_back(taken[i]);
    line.y.push_back(std::max(y, kLowest));
    line.low.push_back(std::max((curve.*vertical.low)[i], kLowest));
    line.high.push_back(std::max((curve.*vertical.high)[i], kLowest));
  }
  return line;
}

// The best so far on a direct problem, which holds until a better one is evaluated: a staircase
// through the very medians of the tables, so that a line crosses τ where the table says. Points
// between and beyond them come from the kept iterations.
PlotSeries stairs(const PlotSeries& kept, const std::vector<std::pair<Real, Real>>& medians) {
  std::vector<std::pair<Real, Real>> points = medians;
  for (std::size_t i = 0; i < kept.x.size(); ++i)
    if (medians.empty() || kept.x[i] < medians.front().first || kept.x[i] > medians.back().first)
      points.emplace_back(kept.x[i], kept.y[i]);
  std::ranges::sort(points, [](const auto& a, const auto& b) {
    return a.first < b.first || (a.first == b.first && a.second > b.second);
  });
  PlotSeries line;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Real y = line.y.empty() ? points[i].second : std::min(points[i].second, line.y.back());
    if (i > 0 && i + 1 < points.size() && y == line.y.back()) continue;
    line.x.push_back(points[i].first);
    line.y.push_back(y);
  }
  return line;
}

// Not-a-number between the points of a line that lie on both sides of stored points which the
// medians lack: what is drawn there is dashed.
PlotSeries with_gaps(const PlotSeries& line, const MedianCurve& curve, const Column& taken) {
  if (std::ranges::count(curve.is_after_gap, true) == 0) return line;
  PlotSeries out = line;
  out.x.clear(), out.y.clear(), out.low.clear(), out.high.clear();
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    bool is_gap = false;
    for (std::size_t k = 1; k < taken.size() && i > 0 && !is_gap; ++k)
      is_gap = curve.is_after_gap[k] && taken[k - 1] < line.x[i] && taken[k] > line.x[i - 1];
    for (const auto column :
         {&PlotSeries::x, &PlotSeries::y, &PlotSeries::low, &PlotSeries::high}) {
      if ((line.*column).empty()) continue;
      if (is_gap) (out.*column).push_back(std::numeric_limits<Real>::quiet_NaN());
      (out.*column).push_back((line.*column)[i]);
    }
  }
  return out;
}

class Curves {
 public:
  Curves(const Comparison& c, std::size_t p) : c_(c), p_(p), ranking_(ranking(c, p)) {
    for (const std::size_t s : ranking_)
      curves_.push_back(median_curve(c, c.cell(p, s), points_per_curve(c)));
    shown_ = shown_at_first(c, ranking_);
    for (const Cell& cell : c.cells[p])
      for (const std::size_t run : cell.runs)
        if (const auto& scale = c.runs[run].record->x_scale) scales_.push_back(*scale);
  }

  // One a quantity and measure; the report's own is marked.
  std::vector<CurveDrawing> all() const {
    std::vector<CurveDrawing> drawings;
    if (curves_.empty()) return drawings;
    const bool is_of_x = is_x_sought() || c_.problems[p_].is_learned;
    const bool has_x = this->has_x();
    for (const Vertical& vertical : kVerticals) {
      const bool is_of_error = &vertical == &kVerticals[1];
      if (is_of_error && !has_x) continue;
      for (const Measure by : is_large(c_) ? std::vector{c_.yardstick.by} : measures_of(c_)) {
        const bool is_own = is_of_error == (has_x && is_of_x) && by == c_.yardstick.by;
        drawings.push_back({drawing_of(vertical, by, is_of_error), by, vertical.name, is_own});
      }
    }
    return drawings;
  }

  // The report's own.
  std::optional<Drawing> own() const {
    if (curves_.empty()) return std::nullopt;
    const bool is_of_error = is_x_sought() || (c_.problems[p_].is_learned && has_x());
    return drawing_of(kVerticals[is_of_error ? 1 : 0], c_.yardstick.by, is_of_error);
  }

 private:
  bool has_x() const {
    return std::ranges::any_of(curves_, [](const MedianCurve& curve) {
      return std::ranges::any_of(curve.x_error, [](Real error) { return std::isfinite(error); });
    });
  }
  bool is_x_sought() const { return c_.problems[p_].aim == Aim::x && !scales_.empty(); }

  Real goal(std::size_t target) const {
    const Real tau = std::pow(10.0, -static_cast<Real>(target) / 5);
    return is_x_sought() ? median_of(scales_) * std::max(tau, c_.problems[p_].least_goal) : tau;
  }

  // The goal of the first target that the answers of at most half of the runs meet; 0 where all are
  // met.
  Real least_unmet(std::size_t s, Measure by) const {
    for (const std::size_t target : targets_of(c_))
      if (c_.cell(p_, s).median(by, target) == kNever) return goal(target);
    return 0;
  }

  // The medians of the tables, which a staircase leads to.
  std::vector<std::pair<Real, Real>> medians(std::size_t s, Measure by) const {
    std::vector<std::pair<Real, Real>> points;
    for (const std::size_t target : targets_of(c_))
      if (const Real taken = c_.cell(p_, s).median(by, target); taken < kNever)
        points.emplace_back(by == Measure::time ? 1e3 * taken : taken, goal(target));
    return points;
  }

  Drawing drawing_of(const Vertical& vertical, Measure by, bool is_of_error) const {
    const bool is_learned = c_.problems[p_].is_learned,
               are_stairs = !is_learned && is_of_error <= is_x_sought();
    const std::string_view counted = counted_name(by), unit = unit_name(by);
    Drawing out{
        .plot = {.kind = Plot::Kind::lines,
                 .title = fmt::format("{} on {}", vertical.label, problem_name(c_.problems[p_])),
                 .x_label =
                     counted == unit ? std::string(counted) : fmt::format("{}, {}", counted, unit),
                 .y_label = vertical.label + std::string(are_stairs ? ", best so far" : ""),
                 .is_log_x = true,
                 .is_log_y = true},
        .join = are_stairs ? Join::steps : Join::straight,
        .has_names = true,
        .shown = shown_};
    Real start = 0;  // the greatest
    for (std::size_t i = 0; i < ranking_.size(); ++i) {
      const std::size_t s = ranking_[i];
      const PlotSeries kept = points_along(curves_[i], vertical, by);
      if (kept.x.empty()) continue;
      start = std::max(start, kept.y.front());
      PlotSeries line = are_stairs ? stairs(kept, is_of_error == is_x_sought()
                                                      ? medians(s, by)
                                                      : std::vector<std::pair<Real, Real>>())
                                   : kept;
      line.optimizer = s;
      line.name = optimizer_name(c_.optimizers[s]);
      line.method = c_.optimizers[s].method;
      if (is_of_error == is_x_sought() && !is_learned)
        line.is_worse_at_end = line.y.back() <= least_unmet(s, by);
      if (is_of_error == is_x_sought() && !is_learned &&
          std::ranges::count(c_.cell(p_, s).is_bound, true) > 0)
        out.bounds.insert(s);
      if (are_stairs || !shown_.contains(s)) line.low.clear(), line.high.clear();
      out.plot.series.push_back(with_gaps(line, curves_[i], taken_along(curves_[i], by)));
    }
    if (is_of_error == is_x_sought() && !is_learned)
      out.tolerance = is_of_error ? median_of(scales_) : 1;
    out.has_points = !are_stairs;
    Window window = window_of(shown_lines(out));
    const Real most = is_of_error ? kHighest * std::max(start, kLowest) : kHighest;
    window.y_high = std::max(std::min(window.y_high, most), 2 * window.y_low);
    out.window = window;
    return out;
  }

  const Comparison& c_;
  std::size_t p_;
  std::vector<std::size_t> ranking_;
  std::vector<MedianCurve> curves_;
  std::set<std::size_t> shown_;
  std::vector<Real> scales_;
};

// --- papers

// The methods that the paper's claims are about, else all or the best of each kind; of a published
// setting and its tuned twin the published one.
std::set<std::size_t> lines_of_paper(const Comparison& c, const Figure& figure) {
  std::vector<std::size_t> all;
  for (const FigureLine& line : figure.lines)
    if (figure.of_the_paper.empty() || figure.of_the_paper.contains(line.optimizer))
      all.push_back(line.optimizer);
  std::erase_if(all, [&](std::size_t s) {
    return std::ranges::any_of(all, [&](std::size_t other) {
      return c.optimizers[s].label == c.optimizers[other].label + ", tuned";
    });
  });
  std::ranges::sort(all);  // by rank
  if (figure.of_the_paper.empty() && all.size() > kMostShown) return shown_at_first(c, all);
  all.resize(std::min(all.size(), kMostShown));
  return {all.begin(), all.end()};
}

// No axis leaves out the end of a line. The overshoot of a path's first steps would flatten all.
Window figure_window(const Figure& figure, const Drawing& drawing) {
  Plot shown = shown_lines(drawing);
  if (figure.kind == "path") {
    constexpr Real kDiverged = 1e3;  // times as far as most
    const auto reach = [](const PlotSeries& line) {
      return std::max(std::abs(line.x.back()), std::abs(line.y.back()));
    };
    std::vector<Real> all;
    for (const PlotSeries& line : shown.series) all.push_back(reach(line));
    std::erase_if(shown.series, [&, most = kDiverged * median_of(all)](const PlotSeries& line) {
      return reach(line) > most;
    });
    for (PlotSeries& line : shown.series) {
      const auto half = static_cast<std::ptrdiff_t>(line.x.size() / 2);
      line.x.erase(line.x.begin(), line.x.begin() + half);
      line.y.erase(line.y.begin(), line.y.begin() + half);
    }
  }
  for (PlotSeries& line : shown.series) {
    if (figure.kind != "scatter") continue;
    std::vector<Real> sorted = line.x;  // a line of what is sought is as wide as it is high
    std::ranges::sort(sorted);
    const Real air = sorted.empty() ? 0 : sorted.back() - sorted.front();
    for (Real& y : line.y)
      if (!sorted.empty()) y = std::clamp(y, sorted.front() - air, sorted.back() + air);
  }
  return window_of(shown);
}

}  // namespace

Drawing figure_drawing(const Comparison& c, const Figure& figure) {
  Drawing out{.plot = {.kind = Plot::Kind::lines,
                       .title = figure.title,
                       .caption = figure.reading,
                       .x_label = figure.x_label,
                       .y_label = figure.y_label,
                       .is_log_x = figure.is_log_x,
                       .is_log_y = figure.is_log_y},
              .join = figure.kind == "scatter" ? Join::none : Join::straight,
              .has_names = figure.kind != "scatter",
              .shown = lines_of_paper(c, figure)};
  for (const FigureLine& line : figure.lines) {
    PlotSeries& drawn = out.plot.series.emplace_back(line_of(c, line.optimizer));
    drawn.x = line.x, drawn.y = line.y, drawn.low = line.low, drawn.high = line.high;
  }
  for (const PublishedMark& mark : figure.published)
    if (out.shown->contains(mark.optimizer))
      out.plot.published.push_back(
          {mark.optimizer, mark.name, {mark.x}, {mark.y}, {mark.low}, {mark.high}});
  out.window = figure_window(figure, out);
  const std::vector<Real> ends = {out.window->x_low, out.window->x_high};
  if (figure.has_diagonal) out.ground.push_back({{}, "", ends, ends, {}, {}});
  return out;
}

std::vector<CurveDrawing> curve_drawings(const Comparison& c, std::size_t p) {
  return Curves(c, p).all();
}

std::optional<Drawing> own_curves(const Comparison& c, std::size_t p) { return Curves(c, p).own(); }

std::string file_name_of(std::string_view title) {
  std::string name;
  for (const char letter : title) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(letter)) != 0;
    if (is_plain)
      name += letter;
    else if (!name.empty() && name.back() != '-')
      name += '-';
  }
  while (name.ends_with('-')) name.pop_back();
  return name.empty() ? "figure" : name;
}

std::vector<NamedDrawing> drawings_of(const Document& document) {
  const Comparison& c = document.comparison;
  std::vector<NamedDrawing> all;
  std::map<std::string, int> counts;
  const auto add = [&](std::string name, Drawing drawing, std::optional<std::size_t> problem = {}) {
    const int count = ++counts[name];
    if (count > 1) name += fmt::format("-{}", count);
    all.push_back({std::move(name), std::move(drawing), problem});
  };
  for (const Section& section : document.sections)
    for (const Plot& plot : section.plots) add(file_name_of(plot.id), drawing_of(plot));
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (std::optional<Drawing> curves = own_curves(c, p))
      add("curves-" + file_name_of(problem_name(c.problems[p])), std::move(*curves), p);
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (Plane& plane : planes_of(c, p)) {
      plane.drawing.plot = shown_lines(plane.drawing);  // all of them would double the file
      plane.drawing.plot.reading = plane.reading;
      const std::string of = plane.drawing.rest.empty() ? "" : plane.drawing.rest + "-";
      add("paths-" + of + file_name_of(problem_name(c.problems[p])), std::move(plane.drawing));
    }
  for (const Figure& one : document.figures)
    if (one.pictures.empty()) add("figure-" + file_name_of(one.title), figure_drawing(c, one));
  for (const Judgement& one : document.claims)
    for (const Plot& plot : claim_section(one).plots)
      add("claim-" + file_name_of(one.id), drawing_of(plot));
  return all;
}

}  // namespace isoline::reports
