// The standings and the matrix in LaTeX, in the style of booktabs, ready to paste; the matrix in
// several tables, so that none is wider than the text of an article.
#include <fmt/format.h>

#include <algorithm>

#include "reports/audit/audit.h"
#include "reports/report.h"
#include "reports/tables/formats.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostColumns = 8;  // problems a table
constexpr std::size_t kMostRows = 45;    // optimizers a page

std::string label_of(const OptimizerAxis& optimizer) {
  return latex_text(shown_spec(optimizer.label)) +
         (optimizer.privileges.empty() ? "" : "\\textsuperscript{\\textdagger}");
}

std::string matrix_cell(const Cell& cell) {
  const std::string text = matrix_text(cell, kTightest);
  std::string out = text == "✗" ? "$\\times$" : latex_text(text);
  if (cell.is_best[kTightest]) out = fmt::format("\\textbf{{{}}}", out);
  const Spread& work = cell.work[kTightest];
  if (cell.is_measured() && !is_complete(cell, kTightest))
    out += fmt::format("\\,{{\\tiny {}/{}}}", work.n - work.unsolved, work.n);
  return out;
}

std::string incomplete(const Comparison& c) {
  if (c.missing.empty()) return "";
  return fmt::format(" \\textbf{{Incomplete: {} of {} cells.}}", c.answered, c.planned);
}

std::string opened(const std::string& caption, const std::string& columns) {
  return "\\begin{table}[p]\n  \\centering\n  \\footnotesize\n  \\setlength{\\tabcolsep}{3.5pt}\n"
         "  \\caption{" +
         caption + "}\n  \\begin{tabular}{" + columns + "}\n    \\toprule\n";
}
constexpr const char* kClosed = "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n\n";

std::string standings(const Comparison& c, std::size_t first, std::size_t last) {
  std::string text = opened(
      fmt::format("{}. Solved: problems whose median run leaves at most $10^{{-6}}$ of the first "
                  "loss, of those given to the optimizer. Best on: with the least work of all. "
                  "Ratio: median over problems of the work over the least, $\\times$ if fewer than "
                  "half are solved. Runs: that get there. \\textdagger: sees what others do "
                  "not.{}",
                  latex_text(headline(c)), incomplete(c)),
      "rlrrrrr");
  text += "    & optimizer & solved & best on & ratio & runs & failed \\\\\n    \\midrule\n";
  for (std::size_t s = first; s < last; ++s) {
    const OptimizerAxis& optimizer = c.optimizers[s];
    const Standing& standing = optimizer.tightest();
    text += fmt::format(
        "    {} & {} & {}/{} & {} & {} & {}/{} & {} \\\\\n", s + 1, label_of(optimizer),
        standing.solved, optimizer.planned, standing.wins,
        standing.typical == kNever ? "$\\times$" : fmt::format("{:.3g}", standing.typical),
        standing.reached, optimizer.runs, optimizer.failed);
  }
  return text + kClosed;
}

// Problems [left, right) of optimizers [first, last).
std::string matrix(const Comparison& c, std::size_t left, std::size_t right, std::size_t first,
                   std::size_t last) {
  std::string text = opened(
      "Median work until $10^{-6}$ of the first loss is left, in forward solves. Bold: least of "
      "its "
      "problem. $\\times$: not reached by half of the runs; small: runs that reached it of all, "
      "where not all did. n/a: the pair makes no sense. Empty: never planned. \\textdagger: sees "
      "what others do not." +
          incomplete(c),
      "l" + std::string(right - left, 'r'));
  text += "    optimizer";
  for (std::size_t p = left; p < right; ++p)
    text += fmt::format(" & \\rotatebox{{90}}{{{}}}", latex_text(shown_spec(c.problems[p].spec)));
  text += " \\\\\n    \\midrule\n";
  for (std::size_t s = first; s < last; ++s) {
    text += "    " + label_of(c.optimizers[s]);
    for (std::size_t p = left; p < right; ++p) text += " & " + matrix_cell(c.cell(p, s));
    text += " \\\\\n";
  }
  return text + kClosed;
}

}  // namespace

std::string latex_report(const Comparison& c) {
  std::string text = "% \\usepackage{booktabs,graphicx}\n";
  const std::size_t optimizers = c.optimizers.size(), problems = c.problems.size();
  for (std::size_t s = 0; s < optimizers; s += kMostRows)
    text += standings(c, s, std::min(s + kMostRows, optimizers));
  // As many columns a table as divides them evenly: 20 problems are 7, 7 and 6.
  const std::size_t tables = std::max<std::size_t>(1, (problems + kMostColumns - 1) / kMostColumns);
  const std::size_t columns = std::max<std::size_t>(1, (problems + tables - 1) / tables);
  for (std::size_t s = 0; s < optimizers; s += kMostRows)
    for (std::size_t p = 0; p < problems; p += columns)
      text += matrix(c, p, std::min(p + columns, problems), s, std::min(s + kMostRows, optimizers));
  return text + audit_latex(c.study->audits) + statistics_latex(c);
}

}  // namespace isoline::reports
