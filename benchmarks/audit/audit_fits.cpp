// What the audit fits to what it measured: power laws of scaling and orders of convergence.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "benchmarks/audit/audit.h"

namespace isoline::benchmarks {
namespace {

struct Line {
  Real slope = kUnknown, residual = kUnknown;
};

// Least squares, summed one by one: vectorized sums would depend on where the points lie in memory.
Line line_through(const std::vector<Real>& x, const std::vector<Real>& y) {
  const auto count = static_cast<Real>(x.size());
  const Real x_mean = std::accumulate(x.begin(), x.end(), 0.0) / count;
  const Real y_mean = std::accumulate(y.begin(), y.end(), 0.0) / count;
  Real spread = 0, shared = 0, squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    spread += (x[i] - x_mean) * (x[i] - x_mean);
    shared += (x[i] - x_mean) * (y[i] - y_mean);
  }
  if (spread == 0) return {};
  const Real slope = shared / spread;
  for (std::size_t i = 0; i < x.size(); ++i)
    squares += std::pow(y[i] - y_mean - slope * (x[i] - x_mean), 2);
  return {slope, std::sqrt(squares / count)};
}

std::vector<Real> decades(const std::vector<Real>& values) {
  std::vector<Real> logarithms;
  for (const Real value : values) logarithms.push_back(std::log10(value));
  return logarithms;
}

bool is_positive(Real value) { return std::isfinite(value) && value > 0; }

}  // namespace

PowerLaw power_law(const std::vector<Real>& scales, std::vector<Real> values) {
  PowerLaw law{.values = std::move(values)};
  if (!std::ranges::all_of(law.values, is_positive)) return law;
  const Line line = line_through(decades(scales), decades(law.values));
  law.exponent = line.slope;
  law.residual = line.residual;
  return law;
}

Approach approach_of(const std::vector<Real>& errors, Real floor) {
  constexpr Real kNear = 0.1;  // what has not come ten times nearer shows no order
  Approach approach;
  if (errors.size() < 2 || !is_positive(errors.front())) return approach;
  std::vector<Real> before, after;
  for (std::size_t i = 1; i < errors.size(); ++i) {
    approach.steps = static_cast<std::int64_t>(i);
    approach.is_exact = errors[i] <= floor;
    if (approach.is_exact) break;
    if (!(errors[i] < errors[i - 1])) continue;  // a rejected step, or the wrong way
    before.push_back(errors[i - 1]);
    after.push_back(errors[i]);
  }
  const Real last =
      approach.is_exact ? errors[static_cast<std::size_t>(approach.steps)] : errors.back();
  approach.remaining = std::isfinite(last) ? last / errors.front() : kUnknown;
  if (before.size() < 2 || !(approach.remaining <= kNear)) return approach;
  const Line line = line_through(decades(before), decades(after));
  approach.order = line.slope;
  approach.residual = line.residual;
  return approach;
}

}  // namespace isoline::benchmarks
