// The report as Markdown, short enough for the summary of a CI job.
#include <fmt/format.h>

#include <algorithm>

#include "reports/readings.h"
#include "reports/report.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline {
namespace {

constexpr std::size_t kMostRows = 60;  // of a matrix, so that a summary stays a summary
constexpr std::size_t kMostFailures = 50;

std::string matrix_cell(const Cell& cell) {
  std::string text = matrix_text(cell, kTightest);
  if (cell.is_best[kTightest]) text = "**" + text + "**";
  if (!cell.privileges.empty()) text += " †";
  if (cell.is_measured() && !is_complete(cell, kTightest))
    text += fmt::format(" ({})", count_text(cell, kTightest));
  return text;
}

std::string matrix(const Comparison& c) {
  std::string text = "| optimizer | solved |", rule = "|---|---:|";
  for (const ProblemAxis& problem : c.problems) {
    text += fmt::format(" {} |", markdown_text(problem.spec));
    rule += "---:|";
  }
  text += "\n" + rule + "\n";
  const std::size_t rows = std::min(c.optimizers.size(), kMostRows);
  for (std::size_t s = 0; s < rows; ++s) {
    text += fmt::format("| {} | {}/{} |", markdown_text(c.optimizers[s].label),
                        c.optimizers[s].solved[kTightest], c.problems.size());
    for (std::size_t p = 0; p < c.problems.size(); ++p)
      text += fmt::format(" {} |", matrix_cell(c.cell(p, s)));
    text += "\n";
  }
  if (rows < c.optimizers.size())
    text += fmt::format("\n{} more optimizers, none ranked higher, are in the page.\n",
                        c.optimizers.size() - rows);
  return text;
}

std::string failures(const Comparison& c) {
  const Study& study = *c.study;
  if (c.failures.empty() && study.unreadable.empty()) return "";
  std::string text = fmt::format("\n## Failures: {} runs, {} unreadable files\n\n",
                                 c.failures.size(), study.unreadable.size());
  for (std::size_t i = 0; i < std::min(c.failures.size(), kMostFailures); ++i) {
    const Record& record = *c.runs[c.failures[i]].record;
    text += fmt::format("- **{}** {} / {} / seed {}: {}\n", name_of(record.status),
                        markdown_text(record.request.problem.spec),
                        markdown_text(record.request.optimizer.spec), record.request.seed,
                        markdown_text(record.message));
  }
  for (std::size_t i = 0; i < std::min(study.unreadable.size(), kMostFailures); ++i)
    text += fmt::format("- **unreadable** {}: {}\n",
                        markdown_text(study.unreadable[i].file.filename().string()),
                        markdown_text(study.unreadable[i].reason));
  return text;
}

}  // namespace

std::string markdown_report(const Comparison& c) {
  std::string text =
      fmt::format("# Isoline report\n\n{}. Status: {}.\n\n", headline(c), status_text(c.statuses));
  if (!c.missing.empty())
    text += fmt::format("> **Incomplete: {}**\n\n", markdown_text(missing_text(c)));
  for (const std::string& remark : remarks(c)) text += fmt::format("- {}\n", markdown_text(remark));
  text += fmt::format("\n## Median work to {}, in forward solves\n\n", kTolerances[kTightest].name);
  text += matrix(c);
  text +=
      "\nBold: the least of its problem. ✗: not reached by half of the runs. (k/n): k of n runs "
      "reached it. n/a: the pair makes no sense. †: the method sees what others do not.\n";
  text += "\n## What this data shows\n\n";
  text += fmt::format("- {}\n", markdown_text(profile_reading(c, kTightest)));
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    text += fmt::format("- **{}** {}\n", markdown_text(c.problems[p].spec),
                        markdown_text(curve_reading(c, p)));
  return text + failures(c);
}

}  // namespace isoline
