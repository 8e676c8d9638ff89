// Medians of curves on a common, thinned grid of iterations.
#include "reports/read/curves.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/results/study.h"

namespace isoline::reports {
namespace {

// A run's curve, with what it cost and what is left of its loss at each of its points.
struct Traced {
  const Curve* curve;
  std::vector<Real> cost, gap;
};

// For a direct problem, the best so far, which holds until a better one is evaluated; for a learned
// one, the value of the network at that iteration.
std::vector<Real> gaps_of(const Run& run, bool is_learned) {
  std::vector<Real> gaps = losses_left(run);
  for (std::size_t i = 1; i < gaps.size() && !is_learned; ++i)
    if (!(gaps[i] <= gaps[i - 1])) gaps[i] = gaps[i - 1];
  return gaps;
}

std::vector<Traced> curves_of(const Comparison& c, const Cell& cell) {
  std::vector<Traced> curves;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    if (run.record->curve.iteration.empty()) continue;
    const ProblemAxis& problem = c.problems[run.problem];
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

MedianCurve median_curve(const Comparison& c, const Cell& cell, std::size_t points) {
  const std::vector<Traced> curves = curves_of(c, cell);
  MedianCurve median;
  if (curves.empty() || !cell.is_measured()) return median;
  std::set<std::int64_t> all;
  for (const Traced& one : curves)
    all.insert(one.curve->iteration.begin(), one.curve->iteration.end());
  const std::vector<std::int64_t> iterations(all.begin(), all.end());
  const std::size_t without_curve = cell.runs.size() - curves.size();
  for (const std::size_t i : thinned(iterations.size(), points)) {
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
  std::vector<Path> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    for (const std::size_t run : c.cell(problem, s).runs) {
      const auto& trajectory = c.runs[run].record->trajectory;
      if (!trajectory || trajectory->x.empty()) continue;
      all.push_back({c.optimizers[s].label, s, trajectory->x, trajectory->y});
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
