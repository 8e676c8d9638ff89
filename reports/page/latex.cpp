// The tables of a report in LaTeX, in the style of booktabs; wide and long tables in several, so
// that each fits a page of an article. Its plots are files that `isoline figures` writes.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>

#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostColumns = 7;  // beside the names of the rows
constexpr std::size_t kMostRows = 45;
constexpr std::size_t kLongHeading = 10;  // characters: longer ones are turned upright

std::string cell_text(const TableCell& cell) {
  std::string text = latex_words(cell.text);
  if (cell.is_best) text = fmt::format("\\textbf{{{}}}", text);
  if (!cell.remark.empty()) text += fmt::format("\\,{{\\tiny {}}}", latex_words(cell.remark));
  return text;
}

std::string heading_text(const Table& table, std::size_t column) {
  const std::string text = latex_words(table.columns[column]);
  const bool is_upright =
      table.align_of(column) == 'r' && table.columns[column].size() > kLongHeading;
  return is_upright ? fmt::format("\\rotatebox{{90}}{{{}}}", text) : text;
}

std::string caption_of(const Table& table, const Part& part) {
  std::string text;
  if (!table.title.empty()) text += latex_words(table.title) + ". ";
  if (!table.reading.empty()) text += latex_words(table.reading) + " ";
  text += latex_words(table.caption);
  for (const std::size_t i : part)
    if (i >= table.names && i < table.meanings.size())
      text +=
          fmt::format("{}: {}. ", latex_words(table.columns[i]), latex_words(table.meanings[i]));
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

// A part of the document: a paper that defines \isolineonly reads the part with that label alone.
std::string part_of_document(const std::string& label, const std::string& text) {
  return fmt::format("\\isolinepart{{{}}}{{%\n{}}}\n\n", label, text);
}

std::string part_text(const Table& table, const Part& part,
                      std::span<const std::vector<TableCell>> rows, const std::string& caption,
                      const std::string& label) {
  std::string align;
  std::vector<std::string> headings;
  for (const std::size_t i : part) {
    align += table.align_of(i);
    headings.push_back(heading_text(table, i));
  }
  std::string text = fmt::format(
      "\\begin{{table}}[p]\n  \\centering\n  \\scriptsize\n  \\setlength{{\\tabcolsep}}{{3pt}}\n"
      "  \\isolinecaption{{{}}}{{tab:{}}}\n  \\isolinefit{{\\begin{{tabular}}{{{}}}\n"
      "    \\toprule\n    {} \\\\\n    \\midrule\n",
      caption, label, align, joined(headings, " & "));
  for (const auto& row : rows) text += row_text(table, part, row);
  return part_of_document(label, text + "    \\bottomrule\n  \\end{tabular}}\n\\end{table}\n");
}

std::string figure_text(const NamedDrawing& one) {
  const Plot& plot = one.drawing.plot;
  return part_of_document(
      one.name, fmt::format("\\begin{{figure}}[p]\n  \\centering\n  \\isolinefigure{{{}}}\n"
                            "  \\isolinecaption{{{}. {} {}}}{{fig:{}}}\n\\end{{figure}}\n",
                            one.name, latex_words(plot.title), latex_words(plot.reading),
                            latex_words(plot.caption), one.name));
}

// Alone, the file is a document. In a paper, \isolineend is empty and the preamble is left out.
constexpr std::string_view kBegin =
    R"(% A document: pdflatex report.tex. Or in a paper, with booktabs and graphicx:
%   \input{report}                               everything
%   \def\isolineonly{curves-heat}\input{report}    the table or plot with this label
% The plots are files of \isolinefigures, written by: isoline figures DIR --format pdf
\providecommand{\isolinefigures}{../figures}
\makeatletter
\long\def\isolinepart#1#2{\def\isolinethis{#1}%
  \ifx\isolineonly\undefined#2\else\ifx\isolineonly\isolinethis#2\fi\fi}
\def\isolinefit#1{\sbox0{#1}\ifdim\wd0>\linewidth\resizebox{\linewidth}{!}{\usebox0}\else\usebox0\fi}
\def\isolinecaption#1#2{{\sloppy\emergencystretch=3em\caption{#1}\label{#2}}}
\def\isolinefigure#1{\IfFileExists{\isolinefigures/#1.pdf}%
  {\includegraphics{\isolinefigures/#1.pdf}}{\fbox{\isolinefigures/#1.pdf is missing}}}
\ifx\@nodocument\relax
  \let\isolineend\relax\let\isolineclear\relax
\else
  \documentclass{article}
  \usepackage[margin=2cm]{geometry}
  \usepackage{booktabs,graphicx}
  \def\isolineend{\end{document}}\let\isolineclear\clearpage
  \begin{document}
\fi
\makeatother
)";

}  // namespace

constexpr std::string_view kGreek =
    "αalpha βbeta γgamma δdelta εvarepsilon ηeta θtheta κkappa λlambda μmu νnu ξxi πpi ρrho σsigma "
    "τtau φvarphi ψpsi ωomega ΔDelta ΛLambda ΣSigma ΦPhi ΩOmega ";

// The marks of a table in the letters that LaTeX has.
std::string latex_words(std::string_view text) {
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
                             {"’", "'"},
                             {"·", "$\\cdot$"},
                             {"²", "$^2$"},
                             {"½", "$\\frac12$"},
                             {"∞", "$\\infty$"},
                             {"—", "---"},
                             {"§", "\\S{}"},
                             {"“", "``"},
                             {"”", "''"},
                             {"√", "$\\surd$"},
                             {"∈", "$\\in$"},
                             {"ö", "\\\"o"},
                             {"ü", "\\\"u"},
                             {"ä", "\\\"a"},
                             {"✓", "$\\surd$"}};
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

// A table of sentences or commands does not fit a page.
std::string latex_report(const Document& document) {
  constexpr int kMostFloats = 12;  // between two page breaks: LaTeX holds 18 at a time
  std::string text(kBegin), first = document.headline + ". ", last;
  int floats = 0;
  const auto add = [&](const std::string& part) {
    text += part;
    if (++floats % kMostFloats == 0) text += "\\isolineclear\n";
  };
  if (!document.incomplete.empty())
    last = fmt::format(" \\textbf{{Incomplete: {} of {} cells.}}", document.comparison.answered,
                       document.comparison.planned);
  std::map<std::string, int> counts;  // of the parts of a table
  for (const Section& section : document.sections)
    for (const Table& table : section.tables)
      for (std::size_t row = 0; row < table.rows.size() && !table.is_wordy(); row += kMostRows)
        for (const Part& part : table_parts(table, kMostColumns)) {
          const std::string caption = latex_words(first) + caption_of(table, part) + last;
          const std::size_t rows = std::min(kMostRows, table.rows.size() - row);
          std::string label = file_name_of(table.id.empty() ? section.id : table.id);
          if (const int count = ++counts[label]; count > 1) label += fmt::format("-{}", count);
          add(part_text(table, part, std::span(table.rows).subspan(row, rows), caption, label));
          first.clear();
        }
  for (const NamedDrawing& one : drawings_of(document)) add(figure_text(one));
  return text + "\\isolineend\n";
}

}  // namespace isoline::reports
