// Lays out the tables of statistics as HTML, Markdown, LaTeX, CSV and JSON.
#include "reports/tables/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/plots/plots.h"
#include "reports/tables/table.h"
#include "reports/tables/tables.h"
#include "reports/text.h"

namespace isoline::reports {
namespace {

// What the i-th row or column is about, as attributes by which the page filters.
std::string about(const std::vector<TableSubject>& subjects, std::size_t i) {
  if (i >= subjects.size()) return "";
  std::string attributes;
  if (subjects[i].optimizer) attributes += fmt::format(" data-s={}", *subjects[i].optimizer);
  if (subjects[i].problem) attributes += fmt::format(" data-p={}", *subjects[i].problem);
  return attributes;
}

std::string html_of(const StatisticTable& table) {
  std::string html = fmt::format(
      "<h3 id=\"{}\">{}</h3><p class=reading>{}</p>\n<details><summary>Table</summary><div "
      "class=scroll tabindex=0 role=region aria-label=\"{}\"><table class=sortable><thead><tr>",
      table.id, html_text(table.title), html_text(table.reading), html_text(table.title));
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    html += fmt::format("<th scope=col{}>{}", about(table.column_subjects, i),
                        html_text(table.columns[i]));
  html += "<tbody>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    html += fmt::format("<tr{}>", about(table.row_subjects, r));
    for (std::size_t i = 0; i < table.rows[r].size(); ++i) {
      const TableCell& cell = table.rows[r][i];
      const std::string note =
          cell.note.empty() ? "" : fmt::format(" title=\"{}\"", html_text(cell.note));
      html += fmt::format("<{}{}{}>{}", i == 0 ? "th scope=row" : "td",
                          about(table.column_subjects, i), note, html_text(cell.text));
    }
    html += "\n";
  }
  return html +
         fmt::format("</table></div><p class=legend>{}</p></details>\n", html_text(table.caption));
}

std::string text_of(const std::string& column) { return column; }
std::string text_of(const TableCell& cell) { return cell.text; }

template <class Cell>
std::string markdown_row(const std::vector<Cell>& cells) {
  std::string row = "|";
  for (const Cell& cell : cells) row += " " + markdown_text(text_of(cell)) + " |";
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
  constexpr Mark kMarks[] = {
      {"✗", "$\\times$"}, {"–", "--"},        {"≤", "$\\le$"},
      {"≥", "$\\ge$"},    {"−", "$-$"},       {"†", "\\textsuperscript{\\textdagger}"},
      {"₀", "$_0$"},      {"×", "$\\times$"}, {"é", "\\'e"},
      {"µ", "$\\mu$"},    {"±", "$\\pm$"}};
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
  const auto line = [&](const auto& cells) {
    text += "    " + latex_cell(text_of(cells[0]));
    for (std::size_t i = first; i < last; ++i) text += " & " + latex_cell(text_of(cells[i]));
    text += " \\\\\n";
  };
  line(table.columns);
  text += "    \\midrule\n";
  for (const auto& row : table.rows) line(row);
  return text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n\n";
}

// Texts as every format prints them, and the numbers they are made of, by name.
nlohmann::json table_json(const StatisticTable& table) {
  nlohmann::json rows = nlohmann::json::array(), values = rows;
  for (const auto& row : table.rows) {
    nlohmann::json texts = nlohmann::json::array(), numbers = texts;
    for (const TableCell& cell : row) {
      texts.push_back(cell.text);
      nlohmann::json named = nlohmann::json::object();
      for (const auto& [name, value] : cell.numbers) named[name] = json_number(value);
      numbers.push_back(std::move(named));
    }
    rows.push_back(std::move(texts));
    values.push_back(std::move(numbers));
  }
  return {{"id", table.id},           {"title", table.title},     {"reading", table.reading},
          {"caption", table.caption}, {"columns", table.columns}, {"rows", rows},
          {"values", values}};
}

}  // namespace

std::string statistics_html(const Comparison& c) {
  std::string html;
  for (const std::string& sentence : c.limits)
    html += fmt::format("<li>{}</li>", html_text(sentence));
  if (!html.empty())
    html = "<h3>What cannot be concluded</h3><ul class=remarks>" + html + "</ul>\n";
  if (!c.tables.empty())
    html += fmt::format(
        "<p class=lead>Orders of methods, ranks and tests among them are by work at declared "
        "prices, which any machine repeats. What runs cost is in {}; the raw counts stand under "
        "Oracle calls and Prices.</p>\n",
        html_text(cost_unit(c)));
  if (!c.plots.empty()) html += "<div class=plots>\n";
  for (const Plot& plot : c.plots) html += plot_html(plot);
  if (!c.plots.empty()) html += "</div>\n";
  for (const StatisticTable& table : c.tables) html += html_of(table);
  return html;
}

std::string statistics_markdown(const Comparison& c) {
  if (c.tables.empty()) return "";
  std::string text = "\n## Statistics\n\n";
  for (const std::string& sentence : c.limits) text += "- " + markdown_text(sentence) + "\n";
  text += fmt::format(
      "\nOrders are by work at declared prices; costs are in {}. The page draws the profiles.\n\n",
      cost_unit(c));
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
        text += fmt::format("{},{},{},{}\n", table.id, csv_field(row[0].text),
                            csv_field(table.columns[i]), csv_field(row[i].text));
  return text;
}

nlohmann::json statistics_json(const Comparison& c) {
  nlohmann::json tables = nlohmann::json::array(), plots = nlohmann::json::array();
  for (const StatisticTable& table : c.tables) tables.push_back(table_json(table));
  for (const Plot& plot : c.plots) plots.push_back(plot_json(plot, c));
  return {{"limits", c.limits}, {"cost_unit", cost_unit(c)}, {"tables", tables}, {"plots", plots}};
}

}  // namespace isoline::reports
