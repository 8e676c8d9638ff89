// Curves, paths and fields of runs for the page, and the window of a plot.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <span>
#include <tuple>

#include "core/results/study.h"
#include "reports/sections/figures.h"

namespace isoline::reports {
namespace {

// A run's curve, with what it cost and what is left of its loss at each of its points: for a direct
// problem the best so far, which holds until a better one is evaluated; for a learned one, the
// value of the network at that iteration.
struct Traced {
  const Curve* curve;
  std::vector<Real> cost, gap;
};

std::vector<Traced> curves_of(const Comparison& c, const Cell& cell) {
  std::vector<Traced> curves;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    if (run.record->curve.iteration.empty()) continue;
    const ProblemAxis& problem = c.problems[run.problem];
    std::vector<Real> gaps = losses_left(run);
    for (std::size_t i = 1; i < gaps.size() && !problem.is_learned; ++i)
      if (!(gaps[i] <= gaps[i - 1])) gaps[i] = gaps[i - 1];
    curves.push_back({&run.record->curve, problem.prices.curve_costs(*run.record), gaps});
  }
  return curves;
}

}  // namespace

std::vector<std::size_t> thinned(std::size_t size, std::size_t count) {
  std::vector<std::size_t> kept;
  if (size <= count) {
    for (std::size_t i = 0; i < size; ++i) kept.push_back(i);
    return kept;
  }
  const Real last = static_cast<Real>(size - 1);
  for (std::size_t k = 0; k < count; ++k) {
    const Real share = static_cast<Real>(k) / static_cast<Real>(count - 1);
    const auto index = static_cast<std::size_t>(std::lround(std::expm1(share * std::log1p(last))));
    if (kept.empty() || index > kept.back()) kept.push_back(index);
  }
  return kept;
}

MedianCurve median_curve(const Comparison& c, const Cell& cell, std::size_t points) {
  const std::vector<Traced> curves = curves_of(c, cell);
  MedianCurve median;
  if (curves.empty() || !cell.is_measured()) return median;
  std::set<std::int64_t> all;
  for (const Traced& one : curves)
    all.insert(one.curve->iteration.begin(), one.curve->iteration.end());
  const std::vector<std::int64_t> iterations(all.begin(), all.end());
  const std::size_t without_curve = cell.runs.size() - curves.size();
  constexpr Real kGap =
      1.33;              // four times the distance of points of which 32 are stored per decade
  std::size_t next = 1;  // stored point
  for (const std::size_t i : thinned(iterations.size(), points)) {
    bool is_after_gap = false;
    for (; next <= i; ++next) {
      const auto from = static_cast<Real>(iterations[next - 1]);
      is_after_gap |= static_cast<Real>(iterations[next]) > std::max(from + 1, kGap * from);
    }
    median.is_after_gap.push_back(is_after_gap);
    std::vector<std::size_t> at;
    for (const Traced& one : curves) at.push_back(point_at(one.curve->iteration, iterations[i]));
    const auto over_runs = [&](std::size_t lost, auto column) {
      std::vector<Real> values(lost, kNever);
      for (std::size_t run = 0; run < curves.size(); ++run)
        values.push_back(static_cast<Real>(column(curves[run])[at[run]]));
      return spread_of(std::move(values));
    };
    const auto of_curve = [](auto Curve::*column) {
      return [column](const Traced& one) -> const auto& { return one.curve->*column; };
    };
    const Spread gap = over_runs(without_curve, std::mem_fn(&Traced::gap));
    const Spread x_error = over_runs(without_curve, of_curve(&Curve::x_error));
    median.iteration.push_back(static_cast<Real>(iterations[i]));
    median.work.push_back(over_runs(0, of_curve(&Curve::work)).median);
    median.cost.push_back(over_runs(0, std::mem_fn(&Traced::cost)).median);
    median.seconds.push_back(over_runs(0, of_curve(&Curve::wall_seconds)).median);
    median.gap.push_back(gap.median);
    median.gap_low.push_back(gap.low);
    median.gap_high.push_back(gap.high);
    median.x_error.push_back(x_error.median);
    median.x_error_low.push_back(x_error.low);
    median.x_error_high.push_back(x_error.high);
  }
  return median;
}

std::vector<Path> paths(const Comparison& c, std::size_t problem) {
  constexpr std::size_t kAll = 8000, kLeast = 12, kMost = 120;  // points
  std::vector<Path> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    std::vector<std::size_t> runs = c.cell(problem, s).runs;
    std::erase_if(runs, [&](std::size_t run) {
      const auto& path = c.runs[run].record->trajectory;
      return !path || path->x.empty();
    });
    if (runs.empty()) continue;
    std::ranges::sort(runs, {}, [&](std::size_t run) {  // of runs without an end, by the loss
      const Real loss = c.runs[run].record->summary.best_loss;
      return std::tuple(c.taken(c.runs[run], Measure::work, kTightest),
                        std::isfinite(loss) ? loss : kNever, run);
    });
    const Run& middle = c.runs[runs[(runs.size() - 1) / 2]];
    all.push_back({s, &middle, &*middle.record->trajectory});
  }
  for (Path& one : all)
    one.kept = thinned(one.points->x.size(), std::clamp(kAll / all.size(), kLeast, kMost));
  return all;
}

Real detour(const std::vector<std::vector<Real>>& path) {
  const auto distance = [](const std::vector<Real>& a, const std::vector<Real>& b) {
    Real sum = 0;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
  };
  if (path.size() < 2) return kNever;
  Real length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += distance(path[i - 1], path[i]);
  const Real direct = distance(path.front(), path.back());
  return std::isfinite(length) && direct > 0 ? length / direct : kNever;
}

// Fields of the best of each kind.

namespace {

Real greatest(std::span<const float> values) {
  Real most = 0;
  for (const float value : values) most = std::max(most, std::abs(Real{value}));
  return most;
}

// The time of the last row of these frames, where their rows are states; 0 elsewhere.
Real time_of(const Sheet* sheet, const FieldFrames& frames) {
  const bool is_of_sheet =
      sheet != nullptr && sheet->field && sheet->field->rows == frames.shape[1];
  return is_of_sheet ? sheet->field->time : 0;
}

// The row of x only: the first one of a history.
std::vector<Real> distances(const FieldFrames& frames, bool is_history) {
  std::vector<Real> apart;
  if (!frames.has_truth()) return apart;
  const Index rows = is_history ? 1 : frames.shape[1];
  const auto cells = static_cast<std::size_t>(rows * frames.shape[2]);
  const std::span<const float> truth = frames.truth();
  for (std::size_t i = 0; i < frames.iterations.size(); ++i) {
    Real rest = 0, whole = 0;
    for (std::size_t k = 0; k < cells; ++k) {
      rest += std::pow(Real{frames.x(i)[k]} - Real{truth[k]}, 2);
      whole += std::pow(Real{truth[k]}, 2);
    }
    apart.push_back(std::sqrt(rest) / std::sqrt(whole));
  }
  return apart;
}

// From the least seed that keeps them, or from this seed if requested.
std::optional<FoundField> field_of(const Comparison& c, std::size_t p, std::size_t s,
                                   std::optional<std::uint64_t>& seed) {
  std::vector<const Record*> records;
  for (const std::size_t run : c.cell(p, s).runs) records.push_back(c.runs[run].record);
  std::ranges::sort(records, {}, [](const Record* record) { return record->request.seed; });
  for (const Record* record : records) {
    if (seed && record->request.seed != *seed) continue;
    std::optional<FieldFrames> frames = c.study->fields_of(*record);
    if (!frames) continue;
    seed = record->request.seed;
    std::vector<Real> apart = distances(*frames, time_of(c.problems[p].sheet, *frames) > 0);
    return FoundField{s, std::move(*frames), std::move(apart)};
  }
  return std::nullopt;
}

}  // namespace

std::optional<FoundFields> found_fields(const Comparison& c, std::size_t p) {
  std::set<std::string> kinds;
  std::optional<std::uint64_t> seed;
  FoundFields out;
  for (const std::size_t s : ranking(c, p)) {
    const std::string kind = c.optimizers[s].mathematics();
    if (kinds.contains(kind)) continue;
    std::optional<FoundField> found = field_of(c, p, s, seed);
    if (!found) continue;
    // The same cells, with a known x* in all or none.
    const auto form = [](const FieldFrames& frames) {
      return std::tuple(frames.shape[1], frames.shape[2], frames.has_truth());
    };
    if (!out.found.empty() && form(found->frames) != form(out.frames())) continue;
    kinds.insert(kind);
    out.found.push_back(std::move(*found));
  }
  if (out.found.empty()) return std::nullopt;
  const FieldFrames& first = out.frames();
  const Sheet* sheet = c.problems[p].sheet;
  const bool is_named = sheet != nullptr && sheet->field.has_value();
  out.x = is_named ? sheet->field->x : Quantity{"x"};
  out.y = is_named ? sheet->field->y : Quantity{"y"};
  out.seed = *seed;
  out.is_learned = c.problems[p].is_learned;
  out.x_scale = greatest(first.has_truth() ? first.truth() : first.x(first.iterations.size() - 1));
  out.time = time_of(sheet, first);
  out.y_scale = out.is_history() ? out.x_scale : greatest(first.target());
  return out;
}

AllFields all_found_fields(const Comparison& c) {
  AllFields all;
  for (std::size_t p = 0; p < c.problems.size(); ++p) all.push_back(found_fields(c, p));
  return all;
}

// The window of a plot of lines.

namespace {

struct Extent {
  Real low = kNever, high = -kNever;
  void take(Real value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// visit(line) for every line that is drawn.
void each_line(const Plot& plot, const auto& visit) {
  std::ranges::for_each(plot.series, visit);
  std::ranges::for_each(plot.published, visit);
}

Extent extent_of(const Plot& plot, std::vector<Real> PlotSeries::*values, bool is_logarithmic) {
  Extent extent;
  each_line(plot, [&](const PlotSeries& line) {
    for (const Real value : line.*values)
      if (value > 0 || !is_logarithmic) extent.take(value);
  });
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
  each_line(plot, [&](const PlotSeries& line) {
    for (const auto* edge : {&line.low, &line.high})
      if (!line.y.empty()) std::ranges::for_each(*edge, take_edge);
  });
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
  Extent x = extent_of(plot, &PlotSeries::x, plot.is_log_x);
  if (!(x.high > x.low)) x = {0, std::max(1.0, 2 * x.low)};
  const Extent y = extent_of_y(plot);
  bool has_start = false;  // iteration 0 is drawn left of the first
  for (const PlotSeries& line : plot.series)
    has_start = has_start || (plot.is_log_x && !line.x.empty() && line.x.front() <= 0);
  return {has_start ? x.low / 2 : x.low, x.high, y.low, y.high};
}

}  // namespace isoline::reports
