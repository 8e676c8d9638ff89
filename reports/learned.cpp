// Learning problems as rows, and as tables in HTML and Markdown.
#include "reports/learned.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/text.h"

namespace isoline::reports {
namespace {

bool is_learned(const Comparison& c, std::size_t p) {
  for (const Cell& cell : c.cells[p])
    for (const std::size_t run : cell.runs)
      return c.runs[run].record->request.problem.is_learned;
  return false;
}

LearnedRow row_of(const Comparison& c, const Cell& cell, std::size_t optimizer) {
  LearnedRow row{.optimizer = optimizer,
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
  return shown_spec(c.optimizers[row.optimizer].label);
}

// rows are in order of their error in x.
void read(const Comparison& c, LearnedProblem& learned) {
  const LearnedRow& nearest = learned.rows.front();
  const auto lowest = std::ranges::min_element(
      learned.rows, {}, [](const LearnedRow& row) { return row.loss.median; });
  learned.ranks_differ = lowest->optimizer != nearest.optimizer;
  learned.reading =
      learned.ranks_differ
          ? fmt::format(
                "Loss and error rank methods differently here: {} has the least loss, {}, at an "
                "error in x of {}; {} has the least error in x, {}, at a loss of {}.",
                label(c, *lowest), figure(lowest->loss.median), figure(lowest->x_error.median),
                label(c, nearest), figure(nearest.x_error.median), figure(nearest.loss.median))
          : fmt::format("{} has both the least error in x, {}, and the least loss, {}.",
                        label(c, nearest), figure(nearest.x_error.median),
                        figure(nearest.loss.median));
}

std::string milliseconds_text(const LearnedRow& row) {
  return (row.is_timed_alone ? "" : "≈ ") + figure(row.milliseconds_each);
}

}  // namespace

std::vector<LearnedProblem> learned_problems(const Comparison& c) {
  std::vector<LearnedProblem> all;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!is_learned(c, p)) continue;
    LearnedProblem learned{.problem = p};
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (const Cell& cell = c.cell(p, s); cell.is_measured())
        learned.rows.push_back(row_of(c, cell, s));
    std::ranges::stable_sort(learned.rows, {},
                             [](const LearnedRow& row) { return row.x_error.median; });
    if (learned.rows.empty()) continue;
    read(c, learned);
    all.push_back(std::move(learned));
  }
  return all;
}

std::string learned_html(const Comparison& c) {
  std::string html;
  for (const LearnedProblem& learned : learned_problems(c)) {
    const Sheet* sheet = c.problems[learned.problem].sheet;
    html += fmt::format(
        "<div data-p={}><h3>{}</h3><p class=reading>{}</p><p class=legend>{}</p><div class=scroll "
        "tabindex=0 role=region "
        "aria-label=\"Learned\"><table class=sortable><thead><tr><th scope=col>optimizer<th "
        "scope=col>error in "
        "x<th scope=col>loss "
        "in y<th scope=col>iterations<th scope=col>ms each<th scope=col>runs<th "
        "scope=col>failed<tbody>\n",
        learned.problem, html_text(shown_spec(c.problems[learned.problem].spec)),
        html_text(learned.reading), sheet == nullptr ? "" : html_text(sheet->note));
    for (const LearnedRow& row : learned.rows)
      html +=
          fmt::format("<tr data-s={}><th scope=row>{}{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}</tr>\n",
                      row.optimizer, html_text(label(c, row)),
                      c.cell(learned.problem, row.optimizer).privileges.empty() ? "" : " †",
                      html_text(figure(row.x_error)), html_text(figure(row.loss)),
                      figure(row.iterations), milliseconds_text(row), row.runs, row.failed);
    html += "</table></div></div>\n";
  }
  return html.empty() ? "<p class=lead>No problem of this report is learned.</p>" : html;
}

std::string learned_markdown(const Comparison& c) {
  std::string text;
  for (const LearnedProblem& learned : learned_problems(c)) {
    const Sheet* sheet = c.problems[learned.problem].sheet;
    text += fmt::format(
        "\n### {}\n\n{}\n\n{}\n\n| optimizer | error in x | loss in y | iterations | ms each | "
        "runs | "
        "failed |\n|---|---:|---:|---:|---:|---:|---:|\n",
        markdown_text(shown_spec(c.problems[learned.problem].spec)), markdown_text(learned.reading),
        sheet == nullptr ? "" : markdown_text(sheet->note));
    for (const LearnedRow& row : learned.rows)
      text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", markdown_text(label(c, row)),
                          figure(row.x_error), figure(row.loss), figure(row.iterations),
                          milliseconds_text(row), row.runs, row.failed);
  }
  return text.empty() ? ""
                      : "\n## What was learned\n\nOn the validation, medians over seeds and "
                        "their range.\n" +
                            text;
}

}  // namespace isoline::reports
