// Medians of curves on a common, thinned grid of iterations.
#include "reports/curves.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace isoline {
namespace {

// Where the curve of a run stands at an iteration: the last kept point not after it.
std::size_t point_at(const Curve& curve, std::int64_t iteration) {
  const auto after = std::ranges::upper_bound(curve.iteration, iteration);
  return after == curve.iteration.begin()
             ? 0
             : static_cast<std::size_t>(after - curve.iteration.begin()) - 1;
}

std::vector<std::int64_t> iterations_of(const std::vector<const Curve*>& curves,
                                        std::size_t points) {
  std::set<std::int64_t> all;
  for (const Curve* curve : curves) all.insert(curve->iteration.begin(), curve->iteration.end());
  const std::vector<std::int64_t> sorted(all.begin(), all.end());
  std::vector<std::int64_t> kept;
  for (const std::size_t i : thinned(sorted.size(), points)) kept.push_back(sorted[i]);
  return kept;
}

template <class Column>
Real median_at(const std::vector<const Curve*>& curves, const std::vector<std::size_t>& at,
               std::size_t without_curve, Column Curve::*column) {
  std::vector<Real> values(without_curve, kNever);
  for (std::size_t i = 0; i < curves.size(); ++i)
    values.push_back(static_cast<Real>((curves[i]->*column)[at[i]]));
  return median_of(std::move(values));
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
  std::vector<const Curve*> curves;
  for (const std::size_t run : cell.runs) {
    const Curve& curve = comparison.runs[run].record->curve;
    if (!curve.iteration.empty()) curves.push_back(&curve);
  }
  MedianCurve median;
  const std::size_t without_curve = cell.runs.size() - curves.size();
  if (curves.empty() || !cell.is_measured()) return median;
  for (const std::int64_t iteration : iterations_of(curves, points)) {
    std::vector<std::size_t> at;
    for (const Curve* curve : curves) at.push_back(point_at(*curve, iteration));
    median.iteration.push_back(static_cast<Real>(iteration));
    median.work.push_back(median_at(curves, at, 0, &Curve::work));
    median.seconds.push_back(median_at(curves, at, 0, &Curve::wall_seconds));
    median.loss.push_back(median_at(curves, at, without_curve, &Curve::loss));
    median.x_error.push_back(median_at(curves, at, without_curve, &Curve::x_error));
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

}  // namespace isoline
