// Medians of curves on a common, thinned grid of iterations.
#include "reports/read/curves.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "reports/read/reached.h"

namespace isoline::reports {
namespace {

// Where the curve of a run stands at an iteration: the last kept point not after it.
std::size_t point_at(const Curve& curve, std::int64_t iteration) {
  const auto after = std::ranges::upper_bound(curve.iteration, iteration);
  return after == curve.iteration.begin()
             ? 0
             : static_cast<std::size_t>(after - curve.iteration.begin()) - 1;
}

// A run's curve, with what it cost and what is left of its loss at each of its points.
struct Traced {
  const Curve* curve;
  std::vector<Real> cost, gap;
};

std::vector<std::int64_t> iterations_of(const std::vector<Traced>& curves, std::size_t points) {
  std::set<std::int64_t> all;
  for (const Traced& traced : curves)
    all.insert(traced.curve->iteration.begin(), traced.curve->iteration.end());
  const std::vector<std::int64_t> sorted(all.begin(), all.end());
  std::vector<std::int64_t> kept;
  for (const std::size_t i : thinned(sorted.size(), points)) kept.push_back(sorted[i]);
  return kept;
}

// value(traced, point) of every run.
template <class Value>
Spread spread_at(const std::vector<Traced>& curves, const std::vector<std::size_t>& at,
                 std::size_t without_curve, Value value) {
  std::vector<Real> values(without_curve, kNever);
  for (std::size_t i = 0; i < curves.size(); ++i)
    values.push_back(static_cast<Real>(value(curves[i], at[i])));
  return spread_of(std::move(values));
}

// Of a direct problem the best so far, which holds until a better one is evaluated; of a learned
// one what the network of that iteration is worth.
std::vector<Real> gaps_of(const Run& run, bool is_learned) {
  std::vector<Real> gaps = losses_left(run);
  for (std::size_t i = 1; i < gaps.size() && !is_learned; ++i)
    if (!(gaps[i] <= gaps[i - 1])) gaps[i] = gaps[i - 1];
  return gaps;
}

void add(const Spread& spread, std::vector<Real>& median, std::vector<Real>& low,
         std::vector<Real>& high) {
  median.push_back(spread.median);
  low.push_back(spread.low);
  high.push_back(spread.high);
}

std::vector<Traced> curves_of(const Comparison& comparison, const Cell& cell) {
  std::vector<Traced> curves;
  for (const std::size_t index : cell.runs) {
    const Run& run = comparison.runs[index];
    if (run.record->curve.iteration.empty()) continue;
    const ProblemAxis& problem = comparison.problems[run.problem];
    curves.push_back({&run.record->curve, problem.prices.curve_costs(*run.record),
                      gaps_of(run, problem.is_learned)});
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

MedianCurve median_curve(const Comparison& comparison, const Cell& cell, std::size_t points) {
  const std::vector<Traced> curves = curves_of(comparison, cell);
  MedianCurve median;
  const std::size_t without_curve = cell.runs.size() - curves.size();
  if (curves.empty() || !cell.is_measured()) return median;
  using At = std::size_t;
  for (const std::int64_t iteration : iterations_of(curves, points)) {
    std::vector<std::size_t> at;
    for (const Traced& one : curves) at.push_back(point_at(*one.curve, iteration));
    const auto over_all = [&](std::size_t lost, auto value) {
      return spread_at(curves, at, lost, value);
    };
    const auto work = [](const Traced& t, At i) { return t.curve->work[i]; };
    const auto cost = [](const Traced& t, At i) { return t.cost[i]; };
    const auto gap = [](const Traced& t, At i) { return t.gap[i]; };
    const auto seconds = [](const Traced& t, At i) { return t.curve->wall_seconds[i]; };
    const auto x_error = [](const Traced& t, At i) { return t.curve->x_error[i]; };
    median.iteration.push_back(static_cast<Real>(iteration));
    median.work.push_back(over_all(0, work).median);
    median.cost.push_back(over_all(0, cost).median);
    median.seconds.push_back(over_all(0, seconds).median);
    add(over_all(without_curve, gap), median.gap, median.gap_low, median.gap_high);
    add(over_all(without_curve, x_error), median.x_error, median.x_error_low, median.x_error_high);
  }
  return median;
}

std::vector<Path> paths(const Comparison& comparison, std::size_t problem) {
  std::vector<Path> all;
  for (std::size_t s = 0; s < comparison.optimizers.size(); ++s)
    for (const std::size_t run : comparison.cell(problem, s).runs) {
      const auto& trajectory = comparison.runs[run].record->trajectory;
      if (!trajectory || trajectory->x.empty()) continue;
      all.push_back({comparison.optimizers[s].label, s, trajectory->x, trajectory->y});
      break;
    }
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

}  // namespace isoline::reports
