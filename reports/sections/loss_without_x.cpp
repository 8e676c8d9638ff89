// A table that compares the two kinds of success: a small loss, and a small error in x. Their
// difference depends on conditioning, because J maps errors in x to errors in y by its singular
// values.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/results/study.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// The result of the median run of a pair.
struct Outcome {
  bool is_loss_reached = false, is_x_found = false;
  bool is_x_near = false;  // to √τ: what a loss at τ leaves of x where J is well conditioned
  bool is_told() const { return is_loss_reached && !is_x_found; }
};

bool are_both_known(const Run& run) {
  return run.record->x_scale && std::isfinite(run.minimum) && run.scale > 0;
}

std::optional<Outcome> outcome_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  if (!cell.is_measured() || is_judged_by_fit(c, p) ||  // whose error is the distance from the fit
      c.where(cell.runs, are_both_known) != cell.runs)
    return std::nullopt;
  const std::size_t target = c.yardstick.tightest().rung,
                    near = rung_of(std::sqrt(c.yardstick.tightest().tau));
  const auto holds_in_the_median = [&](auto holds) {
    const auto unmet = [&](const Run& run) { return holds(run) ? 0 : kNever; };
    return c.aggregate(cell.runs, unmet, cell.missing()).median < kNever;
  };
  return Outcome{holds_in_the_median([&](const Run& run) { return run.loss_met > target; }),
                 holds_in_the_median([&](const Run& run) { return run.x_met > target; }),
                 holds_in_the_median([&](const Run& run) {
                   return !is_failure(run.record->status) && run.x_met > near;
                 })};
}

struct Tally {
  std::size_t n = 0, reached = 0, found = 0, without = 0, far = 0;

  void add(const Outcome& outcome) {
    ++n;
    reached += outcome.is_loss_reached;
    found += outcome.is_x_found;
    without += outcome.is_told();
    far += outcome.is_told() && !outcome.is_x_near;
  }
};

std::optional<Real> condition_of(const ProblemAxis& problem) {
  return problem.has_own_sheet() ? problem.sheet->condition : std::nullopt;
}

// "heat[N=8] (1.2e9)".
std::string with_condition(const ProblemAxis& problem) {
  constexpr Real kSingular = 4.5e15;  // above, the least singular value is rounding
  const std::optional<Real> condition = condition_of(problem);
  if (!condition) return problem_name(problem);
  return fmt::format(
      "{} ({})", problem_name(problem),
      *condition > kSingular ? "singular" : figure(std::stod(fmt::format("{:.2g}", *condition))));
}

std::string names_of(const Comparison& c, std::vector<std::size_t> problems) {
  constexpr std::size_t kNamed = 3;
  std::ranges::stable_sort(problems, std::ranges::greater{},
                           [&](std::size_t p) { return condition_of(c.problems[p]).value_or(0); });
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(problems.size(), kNamed); ++i)
    names.push_back(with_condition(c.problems[problems[i]]));
  if (problems.size() > kNamed) names.push_back(fmt::format("{} more", problems.size() - kNamed));
  return joined(names);
}

std::string without_text(const Tally& all, std::string_view near) {
  if (all.without == 0) return "";
  return " " + words("loss-without-x.without", all.without,
                     all.far == 0 ? "" : words("loss-without-x.far", all.far, near));
}

}  // namespace

Table loss_without_x_table(const Comparison& c) {
  const std::string_view tau = c.yardstick.tightest().name,
                         near = tolerance_at(std::sqrt(c.yardstick.tightest().tau)).name;
  Table table = worded_table("loss-without-x", tau, near);
  Tally all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    Tally own;
    std::vector<std::size_t> without;
    for (std::size_t p = 0; p < c.problems.size(); ++p) {
      const std::optional<Outcome> outcome = outcome_of(c, p, s);
      if (!outcome) continue;
      own.add(*outcome);
      all.add(*outcome);
      if (outcome->is_told()) without.push_back(p);
    }
    if (own.n == 0 || table.rows.size() == kMostTableRows) continue;
    add_row(
        table, c, s,
        {count_cell(own.n), count_cell(own.reached), count_cell(own.found), count_cell(own.without),
         count_cell(own.far), names_of(c, without), failed_cell(c, s)});
  }
  table.reading = all.n == 0 ? words("loss-without-x.none")
                             : words("loss-without-x.reading", all.n, all.reached, tau, all.found,
                                     without_text(all, near));
  return table;
}

}  // namespace isoline::reports
