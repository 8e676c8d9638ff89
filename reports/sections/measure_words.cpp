// Words for the yardstick.
#include "reports/sections/measure_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "reports/read/grounds.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string tau_name(const Comparison& c) { return std::string(c.yardstick.tightest().name); }

std::string_view counted_name(Measure by) {
  constexpr std::array<std::string_view, kMeasures.size()> kNames = {
      "declared work", "cost at measured prices", "iterations", "wall time"};
  return kNames[static_cast<std::size_t>(by)];
}
std::string_view counted_name(const Comparison& c) { return counted_name(c.yardstick.by); }

std::string_view unit_name(Measure by) {
  constexpr std::array<std::string_view, kMeasures.size()> kNames = {
      "forward solves", "equivalent forward solves", "iterations", "ms"};
  return kNames[static_cast<std::size_t>(by)];
}
std::string_view unit_name(const Comparison& c) { return unit_name(c.yardstick.by); }

std::string counted_to_tau(const Comparison& c) {
  const std::string text = fmt::format("{} to {}", counted_name(c), tau_name(c));
  return counted_name(c) == unit_name(c) ? text : fmt::format("{}, in {}", text, unit_name(c));
}

std::string amount(Measure by, Real value) {
  return by == Measure::time ? milliseconds(value) : reached_figure(value);
}
std::string amount(const Comparison& c, Real value) { return amount(c.yardstick.by, value); }

std::string_view time_mark(const Comparison& c, const Cell& cell) {
  return c.yardstick.by == Measure::time && !cell.is_timed_alone ? "≈" : "";
}

std::string_view setting_noun(const Comparison& c) {
  return c.problems.size() > c.names ? "setting" : "problem";
}

std::string_view common_noun(const Comparison& c) {
  return names_of(c, c.order) == c.order.settings.size() ? "problem" : "setting";
}

std::string n_column(const Comparison& c) { return fmt::format("n {}s", setting_noun(c)); }

std::string counted_settings(const Comparison& c, std::size_t count) {
  return counted(count, setting_noun(c));
}

std::string success_text(const Comparison& c) {
  const std::string tau = tau_name(c);
  const auto aims_at_x = static_cast<std::size_t>(std::ranges::count_if(
      c.problems, [](const ProblemAxis& problem) { return problem.aim == Aim::x; }));
  const std::string loss = fmt::format("the relative loss gap is at most {}", tau);
  const std::string x = fmt::format("the error in x is at most {} of the solution’s norm", tau);
  if (aims_at_x == 0) return fmt::format("Solved to {}: {}.", tau, loss);
  if (aims_at_x == c.problems.size()) return fmt::format("Solved to {}: {}.", tau, x);
  return fmt::format("Solved to {}: {}; on the {} whose user wants x, {} instead.", tau, loss,
                     counted_settings(c, aims_at_x), x);
}

}  // namespace isoline::reports
