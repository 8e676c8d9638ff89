// Writes figures, counts and commands.
#include "reports/sections/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/results/statistics.h"
#include "core/shell.h"
#include "reports/sections/claim_terms.h"

namespace isoline::reports {
namespace {

// "1.2e-05" -> "1.2e-5".
std::string without_idle_zeros(std::string text) {
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  std::size_t digits = e + 2;  // after the sign
  while (digits + 1 < text.size() && text[digits] == '0') text.erase(digits, 1);
  if (text[e + 1] == '+') text.erase(e + 1, 1);
  return text;
}

// Four significant digits, "1.200e-04" without the zeros that say nothing: "1.2e-04".
std::string scientific(Real value) {
  std::string text = fmt::format("{:.3e}", value);
  std::size_t end = text.find('e');
  while (text[end - 1] == '0' || text[end - 1] == '.') {
    const bool was_point = text[end - 1] == '.';
    text.erase(--end, 1);
    if (was_point) break;
  }
  return text;
}

}  // namespace

std::string figure(Real value) {
  constexpr Real kInFull = 1e7;
  if (std::isfinite(value) && std::abs(value) < kInFull && value == std::round(value))
    return fmt::format("{:.0f}", std::abs(value) == 0 ? 0.0 : value);
  constexpr Real kScientificBelow = 1e-3;  // 1.842e-4 is shorter than 0.0001842
  const bool is_tiny = std::abs(value) < kScientificBelow;
  std::string text = fmt::format("{:.4g}", value);
  if (is_tiny && text.find('e') == std::string::npos) text = scientific(value);
  return without_idle_zeros(std::move(text));
}

std::string milliseconds(Real seconds) {
  constexpr Real kWhole = 1000;
  const Real value = 1e3 * seconds;
  if (value == kNever) return "✗";
  return value < kWhole ? without_idle_zeros(fmt::format("{:.3g}", value))
                        : fmt::format("{:.0f}", value);
}

std::string exact_figure(Real value) {
  if (std::isfinite(value) && std::abs(value) < 1e15 && value == std::round(value))
    return fmt::format("{:.0f}", value);
  return without_idle_zeros(fmt::format("{}", value));
}

std::string reached_figure(Real value) { return value == kNever ? "✗" : figure(value); }

std::string range_figure(const Spread& spread, std::string (*written)(Real)) {
  if (spread.n <= 1 || spread.low == spread.high) return "";
  return fmt::format("{}–{}", written(spread.low), written(spread.high));
}

std::string figure(const Spread& spread) {
  if (spread.n == 0) return "";
  const std::string range = range_figure(spread, reached_figure);
  return reached_figure(spread.median) + (range.empty() ? "" : fmt::format(" ({})", range));
}

std::string percent(Real share) { return fmt::format("{:.0f} %", 100 * share); }

std::string shown_spec(std::string_view spec) {
  constexpr std::size_t kLong = 7;  // "0.01389" still stands in full
  std::string out;
  for (std::size_t i = 0; i < spec.size();) {
    const std::size_t end = std::min(spec.find_first_not_of("0123456789.e-", i), spec.size());
    const std::string word(spec.substr(i, end - i));
    const bool is_value = i > 0 && spec[i - 1] == '=';
    const bool is_long = word.size() > kLong || word.find("e-0") != std::string::npos;
    char* rest = nullptr;
    const Real value = is_value && is_long ? std::strtod(word.c_str(), &rest) : 0;
    out += rest != nullptr && *rest == 0 ? figure(value) : word;
    if (end < spec.size()) out += spec[end];
    i = end + 1;
  }
  return out;
}

std::string multiple(Real ratio) { return fmt::format("{:.3g}×", ratio); }

int shade_of(Real value, Real least) {
  const auto is_passed = [ratio = value / least](Real step) { return ratio > step; };
  return static_cast<int>(std::ranges::count_if(kShades, is_passed));
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += between;
    text += words[i];
  }
  return text;
}

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string interval_name(std::size_t count) {
  return count < kFewestForInterval ? fmt::format("range of {}", count) : "95 % bootstrap interval";
}

std::string ordinal(std::size_t place) {
  constexpr std::array<const char*, 4> kEnds = {"th", "st", "nd", "rd"};
  const std::size_t last = place % 10, tens = place / 10 % 10;
  return fmt::format("{}{}", place, tens == 1 || last >= kEnds.size() ? "th" : kEnds[last]);
}

std::string problem_name(const ProblemAxis& problem) {
  return shown_spec(problem.label.empty() ? problem.spec : problem.label) +
         marks_text({.is_foreign = problem.is_foreign});
}

std::string optimizer_name(const OptimizerAxis& optimizer) {
  return shown_spec(optimizer.brief) + marks_text({.is_foreign = optimizer.is_foreign});
}

std::string marks_of(const OptimizerAxis& optimizer) {
  Marks marks = optimizer.marks();
  marks.is_foreign = false;  // its name says so
  return marks_text(marks);
}

std::string optimizer_text(const Comparison& c, std::size_t s) {
  return optimizer_name(c.optimizers[s]) + marks_of(c.optimizers[s]);
}

Marks marks_shown(const Comparison& c) {
  Marks shown;
  for (const ProblemAxis& problem : c.problems) shown.is_foreign |= problem.is_foreign;
  for (const OptimizerAxis& axis : c.optimizers) {
    const Marks marks = axis.marks();
    shown.has_extra_information |= marks.has_extra_information;
    shown.is_foreign |= marks.is_foreign;
    shown.is_imported |= marks.is_imported;
  }
  return shown;
}

std::string marks_legend(const Comparison& c) {
  const Marks shown = marks_shown(c);
  std::vector<std::string> all;
  if (shown.has_extra_information) all.emplace_back("†: uses extra information.");
  if (shown.is_foreign) all.emplace_back("‡: computed by another program.");
  if (shown.is_imported) all.emplace_back("§: imported; its values are not verified.");
  return joined(all, " ");
}

std::string status_meaning(Status status) {
  switch (status) {
    case Status::converged:
      return "stopped by the method's own test";
    case Status::target:
      return "reached the target loss of the run";
    case Status::budget:
      return "used up their work or iterations";
    case Status::stalled:
      return "stopped making progress";
    case Status::diverged:
      return "diverged: not finite, or 1e12 times the start";
    case Status::inapplicable:
      return "not applicable to the problem";
    case Status::failed:
      return "ended in an error";
    case Status::crashed:
      return "ended by a signal";
    case Status::timeout:
      return "were stopped at the time limit";
    case Status::memory:
      return "ran out of memory";
    case Status::interrupted:
      return "were interrupted";
    case Status::running:
      break;
  }
  return "did not end";
}

std::string status_text(const std::map<Status, std::size_t>& statuses) {
  std::string text;
  for (const auto& [status, count] : statuses)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name_of(status), count);
  return text;
}

std::string count_text(const Cell& cell, std::size_t tolerance) {
  const Spread& work = cell.headline[tolerance];
  std::string text = fmt::format("{}/{}", work.n - work.unsolved, work.n);
  if (cell.failed > 0) text += fmt::format(", {} failed", cell.failed);
  if (cell.missing() > 0) text += fmt::format(", {} missing", cell.missing());
  return text;
}

std::string matrix_text(const Comparison& c, const Cell& cell, std::size_t tolerance) {
  if (cell.planned == 0) return "";
  if (cell.runs.empty()) return "missing";
  if (!cell.is_measured()) return "n/a";
  const Real median = cell.headline[tolerance].median;
  return amount(c, median) + std::string(median < kNever ? time_mark(c, cell) : "");
}

bool is_complete(const Cell& cell, std::size_t tolerance) {
  return cell.headline[tolerance].unsolved == 0 && cell.failed == 0 && cell.missing() == 0;
}

std::string budget_options(const Request& request) {
  const Budget& budget = request.budget;
  std::string options = fmt::format("--iterations {}", budget.iterations);
  if (budget.work < Budget{}.work) options += fmt::format(" --work {}", budget.work);
  if (budget.seconds < Budget{}.seconds) options += fmt::format(" --time {}s", budget.seconds);
  if (budget.target != Budget{}.target) options += fmt::format(" --target {}", budget.target);
  if (request.threads != 1) options += fmt::format(" --threads {}", request.threads);
  return options + " --rates none";
}

std::string rerun_arguments(const Request& request) {
  return fmt::format("--problem {} --optimizer {} --seeds ={} {}", shell_word(request.problem.spec),
                     shell_word(request.optimizer.spec), request.seed, budget_options(request));
}

std::string rerun_command(const Request& request) {
  return "./isoline run " + rerun_arguments(request);
}

}  // namespace isoline::reports
