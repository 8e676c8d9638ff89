// Lays out the tables of statistics as HTML, Markdown, LaTeX, CSV and JSON.
#include "reports/tables_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "reports/table.h"
#include "reports/text.h"

namespace isoline {
namespace {

std::string html_of(const StatisticTable& table) {
  std::string html = fmt::format(
      "<h3 id=\"{}\">{}</h3><p class=reading>{}</p>\n<details><summary>Table</summary><div "
      "class=scroll tabindex=0 role=region aria-label=\"{}\"><table class=sortable><thead><tr>",
      table.id, html_text(table.title), html_text(table.reading), html_text(table.title));
  for (const std::string& column : table.columns) html += fmt::format("<th>{}", html_text(column));
  html += "<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      html += (i == 0 ? "<th>" : "<td>") + html_text(row[i]);
    html += "\n";
  }
  return html +
         fmt::format("</table></div><p class=legend>{}</p></details>\n", html_text(table.caption));
}

std::string markdown_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + markdown_text(cell) + " |";
  return row + "\n";
}

std::string markdown_of(const StatisticTable& table) {
  std::string text = fmt::format("### {}\n\n{}\n", table.title, markdown_text(table.reading));
  if (table.rows.empty()) return text + "\n";
  text += "\n<details><summary>Table</summary>\n\n" + markdown_row(table.columns) + "|---|";
  for (std::size_t i = 1; i < table.columns.size(); ++i) text += "---:|";
  text += "\n";
  for (const auto& row : table.rows) text += markdown_row(row);
  return text + "\n" + markdown_text(table.caption) + "\n\n</details>\n\n";
}

// The marks of a table in the letters that LaTeX has.
std::string latex_cell(const std::string& text) {
  struct Mark {
    std::string_view letter, command;
  };
  constexpr Mark kMarks[] = {{"✗", "$\\times$"}, {"–", "--"},
                             {"≤", "$\\le$"},    {"≥", "$\\ge$"},
                             {"−", "$-$"},       {"†", "\\textsuperscript{\\textdagger}"},
                             {"₀", "$_0$"}};
  std::string out, plain;
  for (std::size_t i = 0; i < text.size();) {
    const auto* mark = std::ranges::find_if(kMarks, [&](const Mark& one) {
      return std::string_view(text).substr(i).starts_with(one.letter);
    });
    if (mark == std::end(kMarks)) {
      plain += text[i++];
      continue;
    }
    out += latex_text(plain) + std::string(mark->command);
    plain.clear();
    i += mark->letter.size();
  }
  return out + latex_text(plain);
}

// Columns [first, last) beside the names of the rows.
std::string latex_part(const StatisticTable& table, std::size_t first, std::size_t last) {
  std::string text = fmt::format(
      "\\begin{{table}}[p]\n  \\centering\n  \\scriptsize\n  \\setlength{{\\tabcolsep}}{{3pt}}\n"
      "  \\caption{{{}. {} {}}}\n  \\begin{{tabular}}{{l{}}}\n    \\toprule\n",
      latex_cell(table.title), latex_cell(table.reading), latex_cell(table.caption),
      std::string(last - first, 'r'));
  const auto line = [&](const std::vector<std::string>& cells) {
    text += "    " + latex_cell(cells[0]);
    for (std::size_t i = first; i < last; ++i) text += " & " + latex_cell(cells[i]);
    text += " \\\\\n";
  };
  line(table.columns);
  text += "    \\midrule\n";
  for (const auto& row : table.rows) line(row);
  return text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n\n";
}

}  // namespace

std::string statistics_html(const Comparison& c) {
  std::string html;
  for (const std::string& sentence : c.limits)
    html += fmt::format("<li>{}</li>", html_text(sentence));
  if (!html.empty())
    html = "<h3>What cannot be concluded</h3><ul class=remarks>" + html + "</ul>\n";
  for (const StatisticTable& table : c.tables) html += html_of(table);
  return html;
}

std::string statistics_markdown(const Comparison& c) {
  if (c.tables.empty()) return "";
  std::string text = "\n## Statistics\n\n";
  for (const std::string& sentence : c.limits) text += "- " + markdown_text(sentence) + "\n";
  text += "\n";
  for (const StatisticTable& table : c.tables) text += markdown_of(table);
  return text;
}

std::string statistics_latex(const Comparison& c) {
  constexpr std::size_t kMostColumns = 7;  // wider ones are several tables
  std::string text;
  for (const StatisticTable& table : c.tables)
    for (std::size_t i = 1; i < table.columns.size() && !table.rows.empty(); i += kMostColumns)
      text += latex_part(table, i, std::min(i + kMostColumns, table.columns.size()));
  return text;
}

std::string statistics_csv(const Comparison& c) {
  std::string text = "table,row,column,value\n";
  for (const StatisticTable& table : c.tables)
    for (const auto& row : table.rows)
      for (std::size_t i = 1; i < row.size(); ++i)
        text += fmt::format("{},{},{},{}\n", table.id, csv_field(row[0]),
                            csv_field(table.columns[i]), csv_field(row[i]));
  return text;
}

nlohmann::json statistics_json(const Comparison& c) {
  nlohmann::json tables = nlohmann::json::array();
  for (const StatisticTable& table : c.tables)
    tables.push_back({{"id", table.id},
                      {"title", table.title},
                      {"reading", table.reading},
                      {"caption", table.caption},
                      {"columns", table.columns},
                      {"rows", table.rows}});
  return {{"limits", c.limits}, {"tables", tables}};
}

}  // namespace isoline
