// The main table in LaTeX, in the style of booktabs, ready to paste.
#include <fmt/format.h>

#include "reports/report.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline {
namespace {

std::string matrix_cell(const Cell& cell) {
  const std::string text = matrix_text(cell, kTightest);
  std::string out = text == "✗" ? "$\\times$" : latex_text(text);
  if (cell.is_best[kTightest]) out = fmt::format("\\textbf{{{}}}", out);
  if (!cell.privileges.empty()) out += "\\textsuperscript{\\textdagger}";
  if (cell.is_measured() && !is_complete(cell, kTightest))
    out += fmt::format(" {{\\scriptsize {}}}", latex_text(count_text(cell, kTightest)));
  return out;
}

std::string caption(const Comparison& c) {
  std::string text = fmt::format(
      "Median work to $\\tau = 10^{{-6}}$ in forward solves; {}. Bold: least of its problem. "
      "$\\times$: not reached by half of the runs; small: runs that reached it of all runs. n/a: "
      "the pair makes no sense. \\textdagger: the method sees what others do not.",
      latex_text(headline(c)));
  if (!c.missing.empty())
    text += fmt::format(" \\textbf{{Incomplete: {} of {} cells.}}", c.answered, c.planned);
  return text;
}

}  // namespace

std::string latex_report(const Comparison& c) {
  std::string text =
      "% \\usepackage{booktabs,graphicx}\n\\begin{table}\n  \\centering\n  \\small\n"
      "  \\caption{" +
      caption(c) + "}\n  \\begin{tabular}{l" + std::string(c.problems.size(), 'r') +
      "}\n    \\toprule\n    optimizer";
  for (const ProblemAxis& problem : c.problems)
    text += fmt::format(" & \\rotatebox{{90}}{{{}}}", latex_text(problem.spec));
  text += " \\\\\n    \\midrule\n";
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    text += "    " + latex_text(c.optimizers[s].label);
    for (std::size_t p = 0; p < c.problems.size(); ++p) text += " & " + matrix_cell(c.cell(p, s));
    text += " \\\\\n";
  }
  return text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n";
}

}  // namespace isoline
