// Learning problems: the error in x beside the loss in y, and where the two rank methods
// differently, the limitation that Holl, Koltun, Thuerey (2022) name themselves.
#include <fmt/format.h>

#include <algorithm>

#include "reports/sections/origins.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

struct LearnedRow {
  std::size_t problem = 0, optimizer = 0;
  Spread x_error, loss;             // on the validation, after the last iteration, over seeds
  Real iterations = 0;              // median
  Real milliseconds_each = kNever;  // median time of an iteration
  std::size_t runs = 0, failed = 0;
  bool is_timed_alone = true;
};

LearnedRow row_of(const Comparison& c, std::size_t problem, std::size_t optimizer) {
  const Cell& cell = c.cell(problem, optimizer);
  LearnedRow row{.problem = problem,
                 .optimizer = optimizer,
                 .x_error = cell.x_error,
                 .loss = cell.loss,
                 .runs = cell.runs.size(),
                 .failed = cell.failed,
                 .is_timed_alone = cell.is_timed_alone};
  std::vector<Real> iterations, milliseconds;
  for (const std::size_t run : cell.runs) {
    const Summary& summary = c.runs[run].record->summary;
    if (summary.iterations == 0) continue;
    iterations.push_back(static_cast<Real>(summary.iterations));
    milliseconds.push_back(1e3 * summary.wall_seconds / iterations.back());
  }
  if (iterations.empty()) return row;
  row.iterations = median_of(std::move(iterations));
  row.milliseconds_each = median_of(std::move(milliseconds));
  return row;
}

std::string label(const Comparison& c, const LearnedRow& row) {
  return setting_text(c, row.problem, row.optimizer);
}

// Rows are in order of their error in x.
std::string reading_of(const Comparison& c, const std::vector<LearnedRow>& rows) {
  const LearnedRow& nearest = rows.front();
  const auto lowest =
      std::ranges::min_element(rows, {}, [](const LearnedRow& row) { return row.loss.median; });
  if (lowest->optimizer == nearest.optimizer)
    return fmt::format("{} has both the least error in x, {}, and the least loss, {}.",
                       label(c, nearest), figure(nearest.x_error.median),
                       figure(nearest.loss.median));
  return fmt::format(
      "Loss and error rank methods differently here: {} has the least loss, {}, at an error in x "
      "of {}; {} has the least error in x, {}, at a loss of {}.",
      label(c, *lowest), figure(lowest->loss.median), figure(lowest->x_error.median),
      label(c, nearest), figure(nearest.x_error.median), figure(nearest.loss.median));
}

Table table_of(const Comparison& c, std::size_t problem, const std::vector<LearnedRow>& rows) {
  const Sheet* sheet = c.problems[problem].sheet;
  Table table{.id = fmt::format("learned-{}", problem),
              .title = problem_name(c.problems[problem]),
              .reading = reading_of(c, rows),
              .caption = sheet == nullptr ? "" : sheet->note,
              .columns = {"optimizer", "error in x", "loss in y", "iterations", "ms each", "runs",
                          "failed"},
              .topic = {.problem = problem}};
  for (const LearnedRow& row : rows) {
    const bool is_privileged = !c.cell(problem, row.optimizer).privileges.empty();
    table.rows.push_back({label(c, row) + (is_privileged ? " †" : ""), figure(row.x_error),
                          figure(row.loss), figure(row.iterations),
                          (row.is_timed_alone ? "" : "≈ ") + figure(row.milliseconds_each),
                          std::to_string(row.runs), std::to_string(row.failed)});
    table.row_topics.push_back({.optimizer = row.optimizer});
  }
  return table;
}

}  // namespace

Section learned_section(const Comparison& c) {
  Section section{.id = "learned",
                  .title = "What was learned",
                  .otherwise = "No problem of this report is learned."};
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    std::vector<LearnedRow> rows;
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured()) rows.push_back(row_of(c, p, s));
    std::ranges::stable_sort(rows, {}, [](const LearnedRow& row) { return row.x_error.median; });
    if (!rows.empty()) section.tables.push_back(table_of(c, p, rows));
  }
  if (!section.tables.empty())
    section.lead = "On the validation, medians over seeds and their range.";
  return section;
}

}  // namespace isoline::reports
