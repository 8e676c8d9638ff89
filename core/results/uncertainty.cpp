// The conditions of standard deviations, and t intervals.
#include "core/results/uncertainty.h"

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/results/statistics.h"

namespace isoline::results {
namespace {

bool is_examined(Status status) {
  return status == Status::converged || status == Status::target || status == Status::discrepancy;
}

}  // namespace

std::optional<NoiseTest> noise_test(const Record& record) {
  const OptionValues& options = record.request.problem.options;
  const bool has_sigma = record.fit && !record.fit->sigma.empty();
  if (!record.uncertainty || !record.answer || !record.answer->residual_norm ||
      options.number("tikhonov", 0) > 0 || options.text("noise-kind", "gaussian") != "gaussian" ||
      (!has_sigma && !(record.noise_level.value_or(0) > 0)))
    return std::nullopt;
  const auto freedom = static_cast<std::size_t>(record.uncertainty->degrees_of_freedom);
  const auto free = std::ranges::count_if(record.uncertainty->standard_deviation,
                                          [](Real each) { return std::isfinite(each); });
  const Real variance =
      has_sigma ? 1 : std::pow(*record.noise_level, 2) / (Real(freedom) + Real(free));
  const Real value = std::pow(*record.answer->residual_norm, 2) / variance;
  return NoiseTest{value, chi_square_tail(value, freedom), freedom};
}

Doubt doubt_of(const Record& record) {
  if (!is_examined(record.status)) return Doubt::not_minimum;
  if (!record.uncertainty || record.uncertainty->degrees_of_freedom < 1) return Doubt::unknown;
  const auto test = noise_test(record);
  return test && test->p < kLeastP ? Doubt::contradicted : Doubt::none;
}

bool has_log(const Record& record, const std::string& name) {
  std::string names = record.request.problem.options.text("log");
  std::ranges::replace(names, ',', ';');
  const auto cells = cells_of_line(names + ";");
  return std::ranges::find(cells, name) != cells.end();
}

std::vector<XInterval> intervals_of(const Record& record) {
  const Uncertainty& known = *record.uncertainty;
  const Real t = student_quantile(0.975, static_cast<std::size_t>(known.degrees_of_freedom));
  std::vector<XInterval> all;
  for (std::size_t i = 0; i < known.x.size(); ++i) {
    const Real x = known.x[i], half = t * known.standard_deviation[i];
    const bool is_log = x > 0 && record.answer && has_log(record, record.answer->name(i));
    const Real ratio = is_log ? std::exp(half / x) : 1;
    all.push_back(is_log ? XInterval{half, x / ratio, x * ratio}
                         : XInterval{half, x - half, x + half});
  }
  return all;
}

}  // namespace isoline::results
