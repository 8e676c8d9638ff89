// The report as Markdown, short enough for the summary of a CI job.
#include <fmt/format.h>

#include <algorithm>

#include "reports/audit/audit.h"
#include "reports/learned.h"
#include "reports/readings.h"
#include "reports/report.h"
#include "reports/tables/formats.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostRows = 60;  // of a matrix, so that a summary stays a summary
constexpr std::size_t kMostColumns = 7;
constexpr std::size_t kMostFailures = 50;

std::string matrix_cell(const Cell& cell) {
  std::string text = matrix_text(cell, kTightest);
  if (cell.is_best[kTightest]) text = "**" + text + "**";
  if (cell.is_measured() && !is_complete(cell, kTightest))
    text += fmt::format(" ({})", count_text(cell, kTightest));
  return text;
}

std::string label_of(const OptimizerAxis& optimizer) {
  return markdown_text(shown_spec(optimizer.label)) + (optimizer.privileges.empty() ? "" : " †");
}

std::string standings(const Comparison& c) {
  std::string text =
      "|  | optimizer | solved | best on | × least work | runs | failed |\n"
      "|---:|---|---:|---:|---:|---:|---:|\n";
  for (std::size_t s = 0; s < std::min(c.optimizers.size(), kMostRows); ++s) {
    const OptimizerAxis& optimizer = c.optimizers[s];
    const Standing& standing = optimizer.tightest();
    text += fmt::format("| {} | {} | {}/{} | {} | {} | {}/{} | {} |\n", s + 1, label_of(optimizer),
                        standing.solved, optimizer.planned, standing.wins,
                        standing.typical == kNever ? "✗" : fmt::format("{:.3g}", standing.typical),
                        standing.reached, optimizer.runs, optimizer.failed);
  }
  if (kMostRows < c.optimizers.size())
    text += fmt::format("\n{} more optimizers, none ranked higher, are in the page.\n",
                        c.optimizers.size() - kMostRows);
  return text +
         "\nRanked by their performance profiles. Solved: problems whose median run gets there, of "
         "those given to the optimizer. Best on: with the least work of all. × least work: median "
         "over problems; ✗ if it solves fewer than half. Runs: that get there. Failed: errors, "
         "crashes, time or memory limits. †: sees what others do not.\n";
}

// Problems [first, last) as columns: a table with all of them would be too wide to read.
std::string matrix(const Comparison& c, std::size_t first, std::size_t last) {
  std::string text = "\n| optimizer |", rule = "|---|";
  for (std::size_t p = first; p < last; ++p) {
    text += fmt::format(" {} |", markdown_text(shown_spec(c.problems[p].spec)));
    rule += "---:|";
  }
  text += "\n" + rule + "\n";
  for (std::size_t s = 0; s < std::min(c.optimizers.size(), kMostRows); ++s) {
    text += fmt::format("| {} |", label_of(c.optimizers[s]));
    for (std::size_t p = first; p < last; ++p)
      text += fmt::format(" {} |", matrix_cell(c.cell(p, s)));
    text += "\n";
  }
  return text;
}

std::string matrices(const Comparison& c) {
  std::string text;
  for (std::size_t p = 0; p < c.problems.size(); p += kMostColumns)
    text += matrix(c, p, std::min(p + kMostColumns, c.problems.size()));
  return text +
         "\nMedian work to 1e-6, in forward solves. Bold: the least of its problem. ✗: not reached "
         "by half of the runs. (k/n): k of n runs reached it. n/a: the pair makes no sense. Empty: "
         "never planned.\n";
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
  text += "\n## Who solves the problems to 1e-6\n\n";
  for (const std::string& sentence : verdict(c)) text += markdown_text(sentence) + "\n\n";
  text += standings(c);
  text += "\n## Problem by problem\n\n| problem | what this data shows |\n|---|---|\n";
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    text += fmt::format("| {} | {} |\n", markdown_text(shown_spec(c.problems[p].spec)),
                        markdown_text(curve_reading(c, p)));
  const bool is_large = c.problems.size() > kMostColumns;  // folded away, then
  text += is_large ? "\n<details><summary>Every problem and optimizer</summary>\n" : "";
  text += matrices(c);
  text += is_large ? "\n</details>\n" : "";
  return text + learned_markdown(c) + claims_markdown(c.claims) + audit_markdown(c.study->audits) +
         statistics_markdown(c) + failures(c);
}

}  // namespace isoline::reports
