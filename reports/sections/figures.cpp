// Panels to figures: which runs belong to each, and what of them is drawn.
#include "reports/sections/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "reports/read/curves.h"
#include "reports/sections/words.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {
namespace {

const Component& component_of(const Comparison& c, std::size_t problem) {
  static const Component none;
  for (const Cell& cell : c.cells[problem])
    if (!cell.runs.empty()) return c.runs[cell.runs[0]].record->request.problem;
  return none;
}

bool is_wanted(const Component& problem, const Panel& panel) {
  return problem.is_learned && std::ranges::all_of(panel.where, [&](const auto& wanted) {
           return problem.options.number(wanted.first, std::nan("")) == wanted.second;
         });
}

// The problems of one name whose options a panel wants.
std::vector<std::size_t> wanted_problems(const Comparison& c, const std::string& name,
                                         const Panel& panel) {
  std::vector<std::size_t> problems;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (c.problems[p].name == name && is_wanted(component_of(c, p), panel)) problems.push_back(p);
  return problems;
}

// Problems that differ in the swept option alone, together, in its order.
std::vector<Sweep> sweeps_over(const Comparison& c, const std::vector<std::size_t>& problems,
                               const std::string& option) {
  std::map<std::string, Sweep> groups;
  for (const std::size_t p : problems) {
    OptionValues rest = component_of(c, p).options;
    const Real value = rest.number(option, std::nan(""));
    if (std::isnan(value)) continue;
    rest.erase(option);
    std::string key;
    for (const NamedOption& each : rest) key += each.name + "=" + option_text(each.value) + ",";
    groups[key].push_back({value, p});
  }
  std::vector<Sweep> sweeps;
  constexpr std::size_t kFewest = 3;  // two values are no sweep
  for (auto& [key, sweep] : groups) {
    std::ranges::sort(sweep);
    if (sweep.size() >= kFewest) sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

void add(std::vector<Figure>& all, Figure figure, const std::string& problem, const Panel& panel) {
  if (figure.lines.empty() && figure.pictures.empty()) return;
  figure.problem = problem;
  figure.title = panel.title;
  figure.kind = panel.kind;
  all.push_back(std::move(figure));
}

void add_panel(const Comparison& c, const std::string& name, const Panel& panel,
               std::vector<Figure>& all) {
  const std::vector<std::size_t> problems = wanted_problems(c, name, panel);
  if (panel.kind == "sweep") {
    for (const Sweep& sweep : sweeps_over(c, problems, panel.over))
      add(all, sweep_figure(c, sweep, panel), name, panel);
    return;
  }
  for (const std::size_t p : problems)
    add(all, problem_figure(c, p, panel), problem_name(c.problems[p]), panel);
}

}  // namespace

std::vector<Figure> figures(const Comparison& c) {
  std::vector<Figure> all;
  std::set<std::string> known;
  for (const ProblemAxis& problem : c.problems)
    if (problem.sheet != nullptr && known.insert(problem.name).second)
      for (const Panel& panel : problem.sheet->panels) add_panel(c, problem.name, panel, all);
  return all;
}

// The window of a plot of lines: all medians, and not so much of the bands that these lie flat.

namespace {

struct Extent {
  Real low = kNever, high = -kNever;
  void take(Real value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Extent extent_of(const Plot& plot, std::vector<Real> PlotSeries::*values, bool is_logarithmic) {
  Extent extent;
  for (const auto* all : {&plot.series, &plot.published})
    for (const PlotSeries& line : *all)
      for (const Real value : line.*values)
        if (value > 0 || !is_logarithmic) extent.take(value);
  return extent;
}

Extent extent_of_x(const Plot& plot) {
  Extent extent = extent_of(plot, &PlotSeries::x, plot.is_log_x);
  if (!(extent.high > extent.low)) extent = {0, std::max(1.0, 2 * extent.low)};
  return extent;
}

Extent extent_of_y(const Plot& plot) {
  Extent extent = extent_of(plot, &PlotSeries::y, plot.is_log_y);
  const Extent medians = extent;
  constexpr Real kFurther = 3;
  const auto take_edge = [&](Real y) {
    if (std::isnan(y) || medians.low > medians.high || (plot.is_log_y && !(y > 0))) return;
    const Real span = medians.high - medians.low;
    extent.take(plot.is_log_y ? std::clamp(y, medians.low / kFurther, kFurther * medians.high)
                              : std::clamp(y, medians.low - span, medians.high + span));
  };
  for (const auto* all : {&plot.series, &plot.published})
    for (const PlotSeries& line : *all) {
      if (line.y.empty()) continue;
      for (const Real y : line.low) take_edge(y);
      for (const Real y : line.high) take_edge(y);
    }
  if (extent.low > extent.high) return {0.1, 1};
  if (plot.is_log_y) return {extent.low / 1.15, 1.15 * extent.high};  // some air
  // Figures that differ by rounding alone are drawn as one.
  const Real span = extent.high - extent.low;
  const Real size = std::max(std::abs(extent.low), std::abs(extent.high));
  const Real air = span > 1e-9 * size ? 0.05 * span : size > 0 ? 0.5 * size : 0.5;
  return {extent.low - air, extent.high + air};
}

}  // namespace

Window window_of(const Plot& plot) {
  const Extent x = extent_of_x(plot), y = extent_of_y(plot);
  bool has_start = false;  // iteration 0 is drawn left of the first
  for (const PlotSeries& line : plot.series)
    has_start = has_start || (plot.is_log_x && !line.x.empty() && line.x.front() <= 0);
  return {has_start ? x.low / 2 : x.low, x.high, y.low, y.high};
}

// The kinds of panels: medians over seeds with their range, samples and pictures of the first seed.

namespace {

constexpr std::size_t kPoints = 96;  // a line

struct Range {
  Real median, low, high;
};

Range range_of(std::vector<Real> values) {
  const auto [low, high] = std::ranges::minmax(values);
  return {median_of(std::move(values)), low, high};
}

void push(FigureLine& line, Real x, const Range& range) {
  line.x.push_back(x);
  line.y.push_back(range.median);
  line.low.push_back(range.low);
  line.high.push_back(range.high);
}

std::vector<const Record*> records_of(const Comparison& c, std::size_t problem,
                                      std::size_t optimizer) {
  std::vector<const Record*> records;
  for (const std::size_t run : c.cell(problem, optimizer).runs)
    if (!c.runs[run].record->curve.iteration.empty()) records.push_back(c.runs[run].record);
  return records;
}

// A column of each run's curve over iterations; a run that has ended keeps its last value.
using Column = std::function<const std::vector<Real>*(const Record&)>;

FigureLine line_over_iterations(const std::vector<const Record*>& records, const Column& column) {
  FigureLine line;
  const auto longest = std::ranges::max(
      records, {}, [](const Record* record) { return record->curve.iteration.size(); });
  const auto& iterations = longest->curve.iteration;
  for (const std::size_t i : thinned(iterations.size(), kPoints)) {
    std::vector<Real> values;
    for (const Record* record : records)
      if (const auto* one = column(*record); one != nullptr && !one->empty())
        values.push_back((*one)[std::min(i, one->size() - 1)]);
    if (!values.empty()) push(line, static_cast<Real>(iterations[i]), range_of(std::move(values)));
  }
  return line;
}

// For every optimizer with runs on the problem, what `draw` makes of them; empty lines left out.
template <class Draw>
std::vector<FigureLine> lines_of(const Comparison& c, std::size_t problem, Draw draw) {
  std::vector<FigureLine> lines;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const auto records = records_of(c, problem, s);
    if (records.empty()) continue;
    FigureLine line = draw(records);
    line.optimizer = s;
    if (!line.x.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

std::string label(const Comparison& c, const FigureLine& line) {
  return shown_spec(c.optimizers[line.optimizer].brief);
}

// "At the end sip has 0.0129, adam 0.31 (24×), …": the last values, least first.
std::string ends_reading(const Comparison& c, std::vector<FigureLine> lines) {
  std::erase_if(lines, [](const FigureLine& line) { return !std::isfinite(line.y.back()); });
  std::ranges::sort(lines, {}, [](const FigureLine& line) { return line.y.back(); });
  constexpr std::size_t kMost = 8;
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < std::min(kMost, lines.size()); ++i) {
    const Real end = lines[i].y.back(), factor = end / lines[0].y.back();
    parts.push_back(i == 0
                        ? fmt::format("{} has {}", label(c, lines[i]), figure(end))
                        : fmt::format("{} {} ({:.3g}×)", label(c, lines[i]), figure(end), factor));
  }
  return parts.empty() ? "" : fmt::format("At the end {}.", joined(parts));
}

Figure curve_figure(const Comparison& c, std::size_t p) {
  Figure out{.x_label = "iterations",
             .y_label = "error in x, on the validation",
             .is_log_x = true,
             .is_log_y = true};
  out.lines = lines_of(c, p, [](const auto& records) {
    return line_over_iterations(records, [](const Record& r) { return &r.curve.x_error; });
  });
  out.reading = ends_reading(c, out.lines);
  return out;
}

const std::vector<Real>* series_of(const Record& record, const std::string& name) {
  const auto found = record.series.find(name);
  return found == record.series.end() ? nullptr : &found->second;
}

Figure series_figure(const Comparison& c, std::size_t p, const std::string& name) {
  Figure out{.x_label = "iterations", .y_label = name, .is_log_x = true};
  out.lines = lines_of(c, p, [&](const auto& records) {
    return line_over_iterations(records, [&](const Record& r) { return series_of(r, name); });
  });
  std::vector<std::string> ends;
  for (const FigureLine& line : out.lines)
    ends.push_back(fmt::format("{} {}", label(c, line), figure(line.y.back())));
  constexpr std::size_t kMost = 8;
  ends.resize(std::min(kMost, ends.size()));
  out.reading = fmt::format("At the end: {}.", joined(ends));
  return out;
}

Figure path_figure(const Comparison& c, std::size_t p, const std::string& pair) {
  const std::size_t bar = pair.find('|');
  Figure out{.x_label = pair.substr(0, bar), .y_label = pair.substr(bar + 1)};
  out.lines = lines_of(c, p, [&](const auto& records) {
    FigureLine line;
    const auto *x = series_of(*records[0], out.x_label), *y = series_of(*records[0], out.y_label);
    if (x == nullptr || y == nullptr) return line;
    for (const std::size_t i : thinned(x->size(), kPoints)) {
      line.x.push_back((*x)[i]);
      line.y.push_back((*y)[i]);
    }
    return line;
  });
  out.reading = "Paths of the first seed.";
  return out;
}

// take(y*, x*, x) for every number of every sample shown.
template <class Take>
void each_error(const Record& record, Take take) {
  if (!record.exhibit || record.exhibit->is_picture() || record.exhibit->truth.is_empty()) return;
  const Exhibit& shown = *record.exhibit;
  for (Index b = 0; b < shown.x.columns(); ++b)
    for (Index i = 0; i < shown.x.rows() && i < shown.target.rows(); ++i)
      take(shown.target(i, b), shown.truth(i, b), shown.x(i, b));
}

Figure scatter_figure(const Comparison& c, std::size_t p) {
  Figure out{.x_label = "x*", .y_label = "x inferred", .has_diagonal = true};
  std::vector<std::string> errors;
  out.lines = lines_of(c, p, [](const auto& records) {
    std::map<Real, Real> sorted;
    each_error(*records[0], [&](Real, Real truth, Real x) { sorted[truth] = x; });
    FigureLine line;
    for (const auto& [truth, x] : sorted) {
      line.x.push_back(truth);
      line.y.push_back(x);
    }
    return line;
  });
  for (const FigureLine& line : out.lines) {
    std::vector<Real> gaps;
    for (std::size_t i = 0; i < line.x.size(); ++i) gaps.push_back(std::abs(line.y[i] - line.x[i]));
    errors.push_back(fmt::format("{} {}", label(c, line), figure(median_of(std::move(gaps)))));
  }
  out.reading = fmt::format("Median |x − x*| over the samples drawn here, of the first seed: {}.",
                            joined(errors));
  return out;
}

Figure decades_figure(const Comparison& c, std::size_t p) {
  Figure out{.x_label = "y*", .y_label = "|x − x*|, median", .is_log_x = true, .is_log_y = true};
  out.lines = lines_of(c, p, [](const auto& records) {
    std::map<int, std::vector<Real>> decades;
    for (const Record* record : records)
      each_error(*record, [&](Real target, Real truth, Real x) {
        if (target > 0)
          decades[static_cast<int>(std::floor(std::log10(target)))].push_back(std::abs(x - truth));
      });
    FigureLine line;
    constexpr std::size_t kFewest = 5;  // samples that a median says something of
    for (auto& [decade, gaps] : decades)
      if (gaps.size() >= kFewest) push(line, std::pow(10.0, decade + 0.5), range_of(gaps));
    return line;
  });
  if (!out.lines.empty())
    out.reading =
        "Each point is a decade of y*, the last one up to 1. " + ends_reading(c, out.lines);
  return out;
}

}  // namespace

Figure sweep_figure(const Comparison& c, const Sweep& sweep, const Panel& panel) {
  Figure out{.x_label = panel.over,
             .y_label = panel.divided_by.empty()
                            ? "error in x, on the validation"
                            : fmt::format("error in x / {}, on the validation", panel.divided_by),
             .is_log_y = true,
             .is_relative = !panel.divided_by.empty()};
  for (const auto& [value, problem] : sweep)
    out.places.emplace_back(problem_name(c.problems[problem]), value);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    FigureLine line{.optimizer = s};
    for (const auto& [value, problem] : sweep) {
      std::vector<Real> errors;
      for (const Record* record : records_of(c, problem, s)) {
        const OptionValues& options = record->request.problem.options;
        const Real scale =
            panel.divided_by.empty() ? 1 : options.number(panel.divided_by, std::nan(""));
        errors.push_back(record->summary.x_error / scale);
      }
      if (!errors.empty()) push(line, value, range_of(std::move(errors)));
    }
    if (!line.x.empty()) out.lines.push_back(std::move(line));
  }
  out.reading = fmt::format("From {0} = {1} to {0} = {2}. {3}", panel.over, figure(sweep[0].first),
                            figure(sweep.back().first), ends_reading(c, out.lines));
  return out;
}

Figure problem_figure(const Comparison& c, std::size_t p, const Panel& panel) {
  if (panel.kind == "curve") return curve_figure(c, p);
  if (panel.kind == "scatter") return scatter_figure(c, p);
  if (panel.kind == "decades") return decades_figure(c, p);
  if (panel.kind == "series") return series_figure(c, p, panel.quantity);
  if (panel.kind == "path") return path_figure(c, p, panel.quantity);
  return picture_figure(c, p);
}

// Pictures of a sample: what was observed, what each method inferred, and what was to be found.

namespace {

Picture picture_of(std::string title, std::span<const float> field, Index N) {
  return {std::move(title), N, {field.begin(), field.end()}};
}

}  // namespace

Figure picture_figure(const Comparison& c, std::size_t p) {
  Figure out;
  std::vector<Picture> inferred;
  FieldFrames last;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    for (const std::size_t run : c.cell(p, s).runs) {
      const Record* record = c.runs[run].record;
      std::optional<FieldFrames> shown = c.study->fields_of(*record);
      if (!shown || !shown->has_truth() || shown->shape[1] != shown->shape[2]) continue;
      const std::span<const float> x = shown->x(shown->iterations.size() - 1);
      inferred.push_back(picture_of(shown_spec(c.optimizers[s].label), x, shown->shape[1]));
      last = std::move(*shown);
      break;
    }
  if (inferred.empty()) return out;
  out.pictures.push_back(picture_of("y*", last.target(), last.shape[1]));
  for (Picture& picture : inferred) out.pictures.push_back(std::move(picture));
  out.pictures.push_back(picture_of("x*", last.truth(), last.shape[1]));
  out.reading =
      "The first sample of the validation, as inferred after the last iteration of the first seed. "
      "The x share the grey scale of x*.";
  return out;
}

}  // namespace isoline::reports
