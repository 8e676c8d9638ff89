// A section of a report as HTML: its sentences, its plots, its tables.
#include <fmt/format.h>

#include <algorithm>

#include "reports/formats/escape.h"
#include "reports/page/page.h"

namespace isoline::reports {
namespace {

// What an element is about, as attributes by which the page filters.
std::string about(const std::vector<Topic>& topics, std::size_t i) {
  if (i >= topics.size()) return "";
  const Topic& topic = topics[i];
  std::string attributes;
  if (topic.optimizer) attributes += fmt::format(" data-s={}", *topic.optimizer);
  if (topic.problem) attributes += fmt::format(" data-p={}", *topic.problem);
  if (!topic.method.empty())
    attributes += fmt::format(" data-method=\"{}\"", html_text(topic.method));
  if (!topic.claim.empty()) attributes += fmt::format(" data-claim=\"{}\"", html_text(topic.claim));
  return attributes;
}

std::string head_html(const Table& table) {
  std::string html = "<thead><tr>";
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    html += fmt::format("<th scope=col{}>{}", about(table.column_topics, i),
                        html_text(table.columns[i]));
  }
  return html + "<tbody>\n";
}

// Cells and rows are left open, as HTML allows.
std::string cell_html(const Table& table, const TableCell& cell, std::size_t column) {
  const bool is_name = column < table.names;
  const char align = table.align_of(column);
  std::string tag = is_name        ? "th scope=row"
                    : cell.shade   ? fmt::format("td class=h{}", *cell.shade)
                    : align == 'r' ? "td"
                                   : "td class=text";
  tag += about(table.column_topics, column);
  if (!cell.note.empty()) tag += fmt::format(" title=\"{}\"", html_text(cell.note));
  std::string text = html_text(cell.text);
  if (align == 'c' && !text.empty()) text = "<code>" + text + "</code>";
  if (!cell.link.empty()) text = fmt::format("<a href=\"{}\">{}</a>", html_text(cell.link), text);
  if (cell.is_best) text = "<b>" + text + "</b>";
  if (!cell.remark.empty()) text += "<br><small>" + html_text(cell.remark) + "</small>";
  return fmt::format("<{}>{}", tag, text);
}

std::string rows_html(const Table& table) {
  std::string html;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto& row = table.rows[r];
    html += fmt::format("<tr{}>", about(table.row_topics, r));
    const bool is_short = row.size() < table.columns.size();
    for (std::size_t i = 0; i + (is_short ? 1 : 0) < row.size(); ++i)
      html += cell_html(table, row[i], i);
    if (is_short)
      html += fmt::format("<td class=text colspan={}>{}", table.columns.size() - row.size() + 1,
                          html_text(row.back().text));
    html += "\n";
  }
  return html;
}

// What the columns are, in words that need no pointing.
std::string meanings_html(const Table& table) {
  std::string html;
  for (std::size_t i = 0; i < std::min(table.meanings.size(), table.columns.size()); ++i)
    if (!table.meanings[i].empty())
      html += fmt::format("{}<b>{}</b>: {}", html.empty() ? "" : " · ", html_text(table.columns[i]),
                          html_text(table.meanings[i]));
  return html.empty() ? "" : "<p class=legend>" + html + "</p>";
}

std::string table_html(const Table& table, const std::string& name) {
  std::string html;
  if (!table.title.empty())
    html += fmt::format("<h3 id=\"{}\">{}</h3>", table.id, html_text(table.title));
  if (!table.reading.empty())
    html += fmt::format("<p class=reading>{}</p>\n", html_text(table.reading));
  constexpr std::size_t kTall = 25;  // rows: more scroll in a window of their own
  const bool is_tall = table.rows.size() > kTall && !table.is_folded;
  html += fmt::format(
      "{}<div class=\"scroll{}\" tabindex=0 role=region aria-label=\"{}\"><table class=sortable>{}{}"
      "</table></div>",
      table.is_folded ? "<details><summary>Table</summary>" : "", is_tall ? " tall" : "",
      html_text(table.title.empty() ? name : table.title), head_html(table), rows_html(table));
  if (!table.caption.empty())
    html += fmt::format("<p class=legend>{}</p>", html_text(table.caption));
  html += meanings_html(table) + (table.is_folded ? "</details>\n" : "\n");
  const std::string topic = about({table.topic}, 0);
  return topic.empty() ? html : fmt::format("<div{}>{}</div>\n", topic, html);
}

}  // namespace

std::string section_html(const Section& section) {
  if (section.is_empty()) return fmt::format("<p class=lead>{}</p>", html_text(section.otherwise));
  std::string html;
  if (!section.lead.empty()) html += fmt::format("<p class=lead>{}</p>\n", html_text(section.lead));
  for (const Reading& reading : section.readings)
    html += fmt::format(
        "<p class=reading>{}{}</p>\n",
        reading.title.empty() ? "" : fmt::format("<b>{}:</b> ", html_text(reading.title)),
        html_text(reading.text));
  if (!section.plots.empty()) {
    html += "<div class=plots>\n";
    for (const Plot& plot : section.plots) html += plot_html(plot);
    html += "</div>\n";
  }
  for (const Table& table : section.tables) html += table_html(table, section.title);
  return html;
}

}  // namespace isoline::reports
