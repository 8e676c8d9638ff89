// Tables of the two kinds of success held against each other: a small loss, and the x that was
// sought. How far apart they are is a matter of conditioning: J maps errors in x, by its singular
// values, to errors in y.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/results/study.h"
#include "reports/sections/evidence.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr const char* kNeitherTold = "No result has both the least loss and the solution.";

// The result of the median run of a pair.
struct Outcome {
  bool is_loss_reached = false, is_x_found = false;
  bool is_x_near = false;     // to √τ: what a loss at τ leaves of x where J is well conditioned
  Real error = std::nan("");  // of x, as a share of the solution's norm
  bool is_told() const { return is_loss_reached && !is_x_found; }
};

bool are_both_known(const Run& run) {
  return run.record->x_scale && std::isfinite(run.minimum) && run.scale > 0;
}

std::optional<Outcome> outcome_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  if (!cell.is_measured() || c.where(cell.runs, are_both_known) != cell.runs) return std::nullopt;
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
                 }),
                 c.aggregate(cell.runs, [](const Run& run) {
                    return run.record->summary.x_error / *run.record->x_scale;
                  }).median};
}

// Counts over all methods on a setting, or over all settings of a method.
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

std::string condition_text(const ProblemAxis& problem) {
  constexpr Real kSingular = 4.5e15;  // above, the least singular value is rounding
  const std::optional<Real> condition = condition_of(problem);
  if (!condition) return "";
  return *condition > kSingular ? "singular" : figure(std::stod(fmt::format("{:.2g}", *condition)));
}

TableCell condition_cell(const ProblemAxis& problem) {
  const std::optional<Real> condition = condition_of(problem);
  if (!condition) return "";
  return {condition_text(problem), {{"condition", *condition}}};
}

// "heat[N=8] (1.2e9)".
std::string with_condition(const ProblemAxis& problem) {
  const std::string name = problem_name(problem), condition = condition_text(problem);
  return condition.empty() ? name : fmt::format("{} ({})", name, condition);
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

void add_tally(std::vector<TableCell>& row, const Tally& tally) {
  for (const std::size_t count : {tally.n, tally.reached, tally.found, tally.without, tally.far})
    row.push_back(count_cell(count));
}

std::string near_name(const Comparison& c) {
  return std::string(tolerance_at(std::sqrt(c.yardstick.tightest().tau)).name);
}

std::string caption_of(const Comparison& c) {
  const std::string_view tau = c.yardstick.tightest().name;
  return fmt::format(
      "Medians over seeds, where both the least loss and the solution are known. Loss: the "
      "relative loss gap is at most {}. x: the error is at most {} of the solution's norm, or the "
      "floor that the data set. Near: at most {}, the square root, which is what a loss at {} "
      "leaves of x where J is well conditioned: a run whose problem wants a loss stops at its "
      "target in loss, which may be short of x, but not of that. In brackets the condition number "
      "of J, the ratio of its extreme singular values, at the solution or else at the start.",
      tau, tau, near_name(c), tau);
}

}  // namespace

Table loss_without_x_table(const Comparison& c) {
  Table table{.id = "loss-without-x",
              .title = "Solved in loss, not in x",
              .caption = caption_of(c),
              .columns = {"optimizer", "n settings", "loss", "x", "loss, not x", "nor near",
                          "loss, not x, on", "failed"},
              .meanings = {"", "settings given to the method of which both are known",
                           "settings whose loss is reached", "settings whose x is found",
                           "settings whose loss is reached and whose x is not found",
                           "those of them on which x is not even near",
                           "those of them with the worst condition numbers", "failed runs, of all"},
              .align = "lrrrrrlr"};
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
    std::vector<TableCell> row = {optimizer_text(c, s)};
    add_tally(row, own);
    row.emplace_back(names_of(c, without));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
    table.row_topics.push_back({.optimizer = s});
  }
  table.reading =
      all.n == 0
          ? kNeitherTold
          : fmt::format(
                "Of {} pairs of a method and a setting, {} reach the loss to {} and {} find x to "
                "it; {} reach the loss and not x, {} of these not even to {}.",
                all.n, all.reached, c.yardstick.tightest().name, all.found, all.without, all.far,
                near_name(c));
  return table;
}

namespace {

// All methods on one setting.
struct SettingTally : Tally {
  std::vector<Real> errors;  // of those that reach the loss
  std::size_t failed = 0, runs = 0;
};

SettingTally tally_of(const Comparison& c, std::size_t p) {
  SettingTally all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const std::optional<Outcome> outcome = outcome_of(c, p, s);
    if (!outcome) continue;
    all.add(*outcome);
    if (outcome->is_loss_reached) all.errors.push_back(outcome->error);
    all.failed += c.cell(p, s).failed;
    all.runs += c.cell(p, s).runs.size();
  }
  return all;
}

std::vector<TableCell> tally_row(const ProblemAxis& problem, const SettingTally& tally) {
  const bool is_known = problem.sheet != nullptr;
  std::vector<TableCell> row = {
      problem_name(problem),
      is_known ? count_cell(static_cast<std::size_t>(problem.sheet->unknowns)) : TableCell(""),
      condition_cell(problem)};
  add_tally(row, tally);
  const Real error = median_of(tally.errors);
  row.push_back(tally.errors.empty() ? TableCell("")
                                     : TableCell(figure(error), {{"error", error}}));
  row.push_back({fmt::format("{}/{}", tally.failed, tally.runs),
                 {{"failed", Real(tally.failed)}, {"runs", Real(tally.runs)}}});
  return row;
}

}  // namespace

Table condition_table(const Comparison& c) {
  Table table{.id = "condition",
              .title = "Solved in loss, not in x, setting by setting",
              .caption = caption_of(c) +
                         " Error: of x, of the methods that reach the loss, as a share of the "
                         "solution's norm, their median.",
              .columns = {"problem", "unknowns", "condition", "n methods", "loss", "x",
                          "loss, not x", "nor near", "error in x", "failed"}};
  std::vector<std::size_t> order(c.problems.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [&](std::size_t p) { return condition_of(c.problems[p]).value_or(0); });
  std::size_t most = 0;
  table.reading = "On no setting does a method reach the loss without x.";
  for (const std::size_t p : order) {
    const SettingTally tally = tally_of(c, p);
    if (tally.n == 0) continue;
    table.rows.push_back(tally_row(c.problems[p], tally));
    table.row_topics.push_back({.problem = p});
    if (tally.without <= most) continue;
    most = tally.without;
    table.reading =
        fmt::format("Most often on {}: {} of the {} methods that reach its loss do not find its x.",
                    with_condition(c.problems[p]), most, tally.reached);
  }
  if (table.rows.empty()) table.reading = kNeitherTold;
  return table;
}

}  // namespace isoline::reports
