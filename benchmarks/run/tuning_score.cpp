// Scores of tuning, read off records.
#include "benchmarks/run/tuning_score.h"

#include <algorithm>
#include <cmath>

#include "core/ladder.h"

namespace isoline::benchmarks {
namespace {

constexpr Real kTolerance = 1e-6;

Real median(std::vector<Real> values) {
  std::ranges::sort(values, [](Real a, Real b) { return std::isnan(b) ? !std::isnan(a) : a < b; });
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// Until x was found, as the kept iterations tell, or the loss was reached; infinite: never.
Real work_of(const Record& run) {
  const std::size_t target = rung_of(kTolerance);
  if (run.aim == Aim::loss) {
    const bool is_hit = run.hits && run.hits->work.at(target) >= 0;
    return is_hit ? static_cast<Real>(run.hits->work[target]) : INFINITY;
  }
  if (!run.x_scale) return INFINITY;
  const Real goal = x_goal(rung(target), *run.x_scale, run.x_floor);
  for (std::size_t i = 0; i < run.curve.x_error.size(); ++i)
    if (run.curve.x_error[i] <= goal) return static_cast<Real>(run.curve.work[i]);
  return INFINITY;
}

}  // namespace

TuningScore score_of(const std::vector<Record>& runs) {
  std::vector<Real> work, left;
  for (const Record& run : runs) {
    if (is_failure(run.status) || run.status == Status::diverged ||
        run.status == Status::inapplicable)
      return {};
    const Real end = run.aim == Aim::x ? run.summary.x_error : run.summary.loss;
    work.push_back(run.request.problem.is_learned ? INFINITY : work_of(run));
    left.push_back(std::isnan(end) ? INFINITY : end);
  }
  if (runs.empty()) return {};
  return {median(work), median(left)};
}

std::size_t best_value(const std::vector<Real>& values, const std::vector<TuningScore>& scores,
                       Real standard) {
  const auto away = [&](std::size_t i) { return std::abs(std::log(values[i] / standard)); };
  std::size_t best = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (scores[i] < scores[best] || (scores[i] == scores[best] && away(i) < away(best))) best = i;
  return best;
}

std::vector<Real> best_of(std::vector<Real> losses) {
  std::ranges::sort(losses);
  const auto n = losses.size();
  std::vector<Real> expected;
  for (std::size_t b = 1; b <= n; ++b) {
    // C(n − i, b − 1)/C(n, b) by its ratio from one i to the next, i = 1 … n − b + 1.
    Real weight = static_cast<Real>(b) / static_cast<Real>(n), sum = 0;
    for (std::size_t i = 1; i + b <= n + 1; ++i) {
      sum += weight * losses[i - 1];
      weight *=
          static_cast<Real>(n - i - b + 1) / static_cast<Real>(std::max<std::size_t>(1, n - i));
    }
    expected.push_back(sum);
  }
  return expected;
}

}  // namespace isoline::benchmarks
