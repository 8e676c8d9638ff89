// The tables of a report in LaTeX, in the style of booktabs, ready to paste; wide and long ones in
// several, so that each fits a page of an article.
#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostColumns = 7;  // beside the names of the rows
constexpr std::size_t kMostRows = 45;
constexpr std::size_t kLongHeading = 10;  // characters: longer ones are turned upright

constexpr std::string_view kGreek =
    "αalpha βbeta γgamma δdelta εvarepsilon ηeta θtheta κkappa λlambda μmu νnu ξxi πpi ρrho σsigma "
    "τtau φvarphi ψpsi ωomega ΔDelta ΛLambda ΣSigma ΦPhi ΩOmega ";

// The marks of a table in the letters that LaTeX has.
std::string marked_text(std::string_view text) {
  struct Mark {
    std::string_view letter, command;
  };
  constexpr Mark kMarks[] = {{"✗", "$\\times$"},
                             {"–", "--"},
                             {"≤", "$\\le$"},
                             {"≥", "$\\ge$"},
                             {"−", "$-$"},
                             {"†", "\\textsuperscript{\\textdagger}"},
                             {"‡", "\\textsuperscript{\\textdaggerdbl}"},
                             {"₀", "$_0$"},
                             {"×", "$\\times$"},
                             {"é", "\\'e"},
                             {"µ", "$\\mu$"},
                             {"±", "$\\pm$"},
                             {"→", "$\\to$"},
                             {"≈", "$\\approx$"},
                             {"⁻¹", "$^{-1}$"},
                             {"…", "\\ldots{}"},
                             {"°", "$^\\circ$"},
                             {"∂", "$\\partial$"},
                             {"‖", "$\\|$"},
                             {"∇", "$\\nabla$"},
                             {"ᵀ", "$^T$"},
                             {"₁", "$_1$"},
                             {"ᵣ", "$_r$"},
                             {"’", "'"}};
  constexpr std::size_t kLetter = 2;  // bytes of a Greek letter
  std::string out, plain;
  while (!text.empty()) {
    if (const auto at = kGreek.find(text.substr(0, kLetter));
        text.size() >= kLetter && at != kGreek.npos && text[0] < 0) {
      const std::string_view name = kGreek.substr(at + kLetter);
      out += fmt::format("{}$\\{}$", latex_text(plain), name.substr(0, name.find(' ')));
      plain.clear();
      text.remove_prefix(kLetter);
      continue;
    }
    const auto* mark =
        std::ranges::find_if(kMarks, [&](const Mark& one) { return text.starts_with(one.letter); });
    if (mark == std::end(kMarks)) {
      plain += text.front();
      text.remove_prefix(1);
      continue;
    }
    out += latex_text(plain) + std::string(mark->command);
    plain.clear();
    text.remove_prefix(mark->letter.size());
  }
  return out + latex_text(plain);
}

std::string cell_text(const TableCell& cell) {
  std::string text = marked_text(cell.text);
  if (cell.is_best) text = fmt::format("\\textbf{{{}}}", text);
  if (!cell.remark.empty()) text += fmt::format("\\,{{\\tiny {}}}", marked_text(cell.remark));
  return text;
}

std::string heading_text(const Table& table, std::size_t column) {
  const std::string text = marked_text(table.columns[column]);
  const bool is_upright =
      table.align_of(column) == 'r' && table.columns[column].size() > kLongHeading;
  return is_upright ? fmt::format("\\rotatebox{{90}}{{{}}}", text) : text;
}

std::string caption_of(const Table& table, const Part& part) {
  std::string text;
  if (!table.title.empty()) text += marked_text(table.title) + ". ";
  if (!table.reading.empty()) text += marked_text(table.reading) + " ";
  text += marked_text(table.caption);
  for (const std::size_t i : part)
    if (i >= table.names && i < table.meanings.size())
      text +=
          fmt::format("{}: {}. ", marked_text(table.columns[i]), marked_text(table.meanings[i]));
  return text;
}

std::string row_text(const Table& table, const Part& part, const std::vector<TableCell>& row) {
  std::vector<std::string> cells;
  const bool is_short = row.size() < table.columns.size();
  for (const std::size_t i : part)
    if (i < table.names || !is_short) cells.push_back(cell_text(row[i]));
  if (is_short)
    cells.push_back(fmt::format("\\multicolumn{{{}}}{{l}}{{{}}}", part.size() - table.names,
                                cell_text(row.back())));
  return "    " + joined(cells, " & ") + " \\\\\n";
}

std::string part_text(const Table& table, const Part& part,
                      std::span<const std::vector<TableCell>> rows, const std::string& caption) {
  std::string align;
  std::vector<std::string> headings;
  for (const std::size_t i : part) {
    align += table.align_of(i);
    headings.push_back(heading_text(table, i));
  }
  std::string text = fmt::format(
      "\\begin{{table}}[p]\n  \\centering\n  \\scriptsize\n  \\setlength{{\\tabcolsep}}{{3pt}}\n"
      "  \\caption{{{}}}\n  \\begin{{tabular}}{{{}}}\n    \\toprule\n    {} \\\\\n    \\midrule\n",
      caption, align, joined(headings, " & "));
  for (const auto& row : rows) text += row_text(table, part, row);
  return text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n\n";
}

}  // namespace

// A table of sentences or commands does not fit a page.
std::string latex_report(const Document& document) {
  std::string text = "% \\usepackage{booktabs,graphicx}\n", first = document.headline + ". ", last;
  if (!document.incomplete.empty())
    last = fmt::format(" \\textbf{{Incomplete: {} of {} cells.}}", document.comparison.answered,
                       document.comparison.planned);
  for (const Section& section : document.sections)
    for (const Table& table : section.tables)
      for (std::size_t row = 0; row < table.rows.size() && !table.is_wordy(); row += kMostRows)
        for (const Part& part : table_parts(table, kMostColumns)) {
          const std::string caption = latex_text(first) + caption_of(table, part) + last;
          const std::size_t rows = std::min(kMostRows, table.rows.size() - row);
          text += part_text(table, part, std::span(table.rows).subspan(row, rows), caption);
          first.clear();
        }
  return text;
}

}  // namespace isoline::reports
