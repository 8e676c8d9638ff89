// A section of a report as HTML: its sentences, its plots, its tables.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "core/files.h"
#include "core/records/sheet.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string prose_html(std::string_view text) {
  std::string html;
  std::size_t open = 0, close = 0;
  while ((open = text.find('`')) != text.npos && (close = text.find('`', open + 1)) != text.npos) {
    html += html_text(text.substr(0, open)) + "<code>" +
            html_text(text.substr(open + 1, close - open - 1)) + "</code>";
    text.remove_prefix(close + 1);
  }
  return html + html_text(text);
}

namespace {

// A button that copies the text by a script.
std::string command_button(const std::string& command) {
  return fmt::format("<button class=copy data-command=\"{}\">copy</button>", html_text(command));
}

std::string about(const std::vector<Topic>& topics, std::size_t i) {
  return i < topics.size() ? topic_attributes(topics[i]) : "";
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
  if (cell.of) tag += fmt::format(" data-of=\"{} {}\"", cell.of->first, cell.of->second);
  if (!cell.note.empty()) tag += fmt::format(" title=\"{}\"", html_text(cell.note));
  std::string text = prose_html(cell.text);
  if (align == 'c' && !text.empty()) text = "<code>" + text + "</code>";
  if (!cell.link.empty()) text = fmt::format("<a href=\"{}\">{}</a>", html_text(cell.link), text);
  if (cell.is_best) text = "<b>" + text + "</b>";
  if (!cell.remark.empty()) text += "<small>" + html_text(cell.remark) + "</small>";
  return fmt::format("<{}>{}", tag, text);
}

std::string rows_html(const Table& table) {
  std::string html = "<thead><tr>";
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    html += fmt::format("<th scope=col{}>{}", about(table.column_topics, i),
                        html_text(table.columns[i]));
  html += "<tbody>\n";
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

// "; <b>name</b>: meaning"; the first entry does not have the semicolon.
void add_meaning(std::string& html, const std::string& name, const std::string& meaning) {
  if (!meaning.empty())
    html += fmt::format("{}<b>{}</b>: {}", html.empty() ? "" : "; ", html_text(name),
                        html_text(meaning));
}

std::string table_html(const Table& table, const std::string& name) {
  std::string html, meanings;
  if (!table.title.empty())
    html += fmt::format("<h3 id=\"{}\">{}</h3>", table.id, html_text(table.title));
  if (!table.reading.empty())
    html += fmt::format("<p class=reading>{}</p>\n", html_text(table.reading));
  constexpr std::size_t kTall = 25;  // rows: more scroll in a window of their own
  const bool is_tall = table.rows.size() > kTall && !table.is_folded;
  html += fmt::format(
      "{}<div class=\"scroll{}\" tabindex=0 role=group aria-label=\"{}\"><table class=sortable "
      "data-table=\"{}\">{}</table></div>",
      table.is_folded ? "<details><summary>Table</summary>" : "", is_tall ? " tall" : "",
      html_text(table.title.empty() ? name : table.title), table.id, rows_html(table));
  if (!table.caption.empty())
    html += fmt::format("<p class=legend>{}</p>", html_text(table.caption));
  for (std::size_t i = 0; i < std::min(table.meanings.size(), table.columns.size()); ++i)
    add_meaning(meanings, table.columns[i], table.meanings[i]);
  if (!meanings.empty()) html += "<p class=legend>" + meanings + "</p>";
  html += table.is_folded ? "</details>\n" : "\n";
  const std::string topic = topic_attributes(table.topic);
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
        prose_html(reading.text));
  if (!section.plots.empty()) {
    html += "<div class=plots>\n";
    for (const Plot& plot : section.plots) html += plot_html(plot);
    html += "</div>\n";
  }
  for (const Table& table : section.tables) html += table_html(table, section.title);
  return html;
}

// The claims of the page: the verdicts, and for each claim a part of its own that opens when its
// row leads there.

namespace {

// A path as a relative address.
std::string address(const std::string& path) {
  std::string out;
  for (const char letter : path) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool is_plain = std::isalnum(byte) != 0 || std::string_view("-._~/").find(letter) < 5;
    out += is_plain ? std::string(1, letter) : fmt::format("%{:02X}", byte);
  }
  return out;
}

// The path from the page to a record; empty if either place is unknown.
std::string record_link(const Document& document, const std::string& name) {
  if (document.out.empty()) return "";
  for (const std::filesystem::path folder : document.comparison.study->folders) {
    std::error_code unknown;
    const std::filesystem::path file = folder / "runs" / name;
    if (!is_there(file)) continue;
    const std::string way =
        std::filesystem::proximate(file, document.out, unknown).generic_string();
    return unknown ? "" : address(way);
  }
  return "";
}

std::string claim_html(const Document& document, const Judgement& judgement) {
  Section claim = claim_section(judgement);
  for (Table& table : claim.tables) {
    table.is_folded = false;  // its part is
    if (!table.columns.empty() && table.columns.back() == "record")
      for (auto& row : table.rows) row.back().link = record_link(document, row.back().text);
  }
  std::string html = fmt::format(
      "<details class=claim id=\"{0}\" data-claim=\"{1}\"><summary><b>{2}</b> {3} "
      "<code>{1}</code></summary><noscript>\n<div class=decided><dl>",
      html_text(claim.id), html_text(judgement.id), html_text(marked_verdict(judgement)),
      html_text(claim.title));
  for (const Reading& reading : claim.readings)
    html += fmt::format("<dt>{}<dd>{}", html_text(reading.title), html_text(reading.text));
  if (!claim.command.empty())
    html += fmt::format("<dt>To repeat it<dd><code>{}</code> {}", html_text(claim.command),
                        command_button(claim.command));
  html += "</dl>\n<div>";
  for (const Plot& plot : claim.plots) html += plot_html(plot);
  html += "</div></div>\n";
  claim.readings.clear();
  claim.plots.clear();
  if (!claim.tables.empty()) html += section_html(claim);
  return html + "<p><a href=\"#claims\">All verdicts</a></p></noscript></details>\n";
}

}  // namespace

std::string runs_address(const Document& document) {
  const auto& runs = document.comparison.runs;
  const std::string link = runs.empty() ? "" : record_link(document, runs[0].record->file_name());
  return link.substr(0, link.rfind('/') + 1);
}

std::string claims_html(const Document& document) {
  std::string html = section_html(document.section("claims"));
  if (document.claims.empty()) return html;
  html += "<h3>Evidence for each claim</h3>\n<div class=each-claim>";
  for (const Judgement& judgement : document.claims) html += claim_html(document, judgement);
  return html + "</div>";
}

Table cells_table(const Comparison& c,
                  const std::vector<std::pair<std::size_t, std::size_t>>& cells) {
  const auto spread_cell = [](const Spread& spread, std::string (*text)(Real)) {
    TableCell cell = spread.n == 0 ? "" : text(spread.median);
    cell.remark = range_figure(spread, text);
    return cell;
  };
  const Measure by = c.yardstick.by == Measure::time ? Measure::work : c.yardstick.by;
  Table table{.columns = {"problem", "optimizer", "runs to " + tau_name(c)},
              .align = "llrrrrrrrrrl",
              .names = 2};
  for (const std::string_view what : {name_of(by), std::string_view("time, ms,")})
    for (const Tolerance& tolerance : c.yardstick.tolerances)
      table.columns.push_back(fmt::format("{} to {}", what, tolerance.name));
  for (const char* last : {"final loss", "final error in x", "how the runs ended"})
    table.columns.emplace_back(last);
  for (const auto& [p, s] : cells) {
    const Cell& cell = c.cell(p, s);
    if (cell.planned == 0) continue;
    table.row_topics.push_back({.optimizer = s, .problem = p});
    auto& row = table.rows.emplace_back();
    row = {problem_name(c.problems[p]),
           setting_text(c, p, s) + (cell.privileges.empty() ? "" : " †")};
    if (!cell.is_measured()) {
      row.push_back(cell.runs.empty() ? "missing" : "n/a: " + cell.inapplicable);
      continue;
    }
    row.push_back(count_text(cell, kTightest));
    for (std::size_t t = 0; t < kTolerances.size(); ++t) {
      row.push_back(spread_cell(cell.taken[by][t], reached_figure));
      row.back().is_best = cell.is_best[t];
    }
    for (const Spread& seconds : cell.taken[Measure::time]) {
      row.push_back(spread_cell(seconds, milliseconds));
      if (!cell.is_timed_alone && seconds.is_solved()) row.back().text += "≈";
    }
    row.push_back(spread_cell(cell.loss, reached_figure));
    row.push_back(spread_cell(cell.x_error, reached_figure));
    row.push_back(status_text(cell.statuses));
  }
  return table;
}

// The table of all cells. Scripts sort and filter it; without scripts it is complete.
std::string details_html(const Comparison& c) {
  constexpr std::size_t kMost = 20'000;  // rows of some 200 bytes
  if (c.problems.size() * c.optimizers.size() > kMost)
    return fmt::format(
        "<p class=lead>This report has more than {} cells, too many for a table: report.csv "
        "contains all of them.</p>",
        kMost);
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s) all.emplace_back(p, s);
  Table table = cells_table(c, all);
  table.align.back() = 'r';  // the style sheet aligns it, without a class in each row
  return "<table class=sortable id=detail-table>" + rows_html(table) + "</table>";
}

// The table of measured properties, with one row per method, which opens its details.

namespace {

struct Property {
  const char *name, *meaning;
};
constexpr Property kProperties[] = {
    {"units of x", "the path in y is the same in other units of each component of x"},
    {"rotation of x", "the path in y is the same in rotated coordinates of x"},
    {"linear map of x", "the path in y is the same under any linear map of x"},
    {"units of y", "the path in x is the same in other units of each component of y"},
    {"rotation of y", "the path in x is the same in rotated coordinates of y"},
    {"linear map of y", "the path in x is the same under any linear map of y"},
    {"one step", "reaches a regular solution in one step"},
    {"superlinear", "order 1.5 or more near a regular solution"},
    {"order if singular", "order 1.5 or more where J is singular at the solution"},
    {"as declared", "no measurement contradicts what the method declares"}};

// Whether each property holds; no value if it was not measured.
std::array<std::optional<bool>, std::size(kProperties)> answers_of(
    const AuditedOptimizer& audited) {
  constexpr Real kLeastOrder = 1.5;
  const auto is_in_one_step = [](const Approach& approach) {
    return approach.is_exact && approach.steps == 1;
  };
  const auto has_order = [&](const Approach& approach) -> std::optional<bool> {
    if (std::isnan(approach.remaining)) return std::nullopt;
    return is_in_one_step(approach) ||
           (approach.residual <= kMostOrderResidual && approach.order >= kLeastOrder);
  };
  std::array<std::optional<bool>, std::size(kProperties)> answers;
  std::size_t at = 0;
  for (const Real deviation : audited.deviations) {
    if (!std::isnan(deviation)) answers[at] = deviation <= kInvariantDeviation;
    ++at;
  }
  if (!std::isnan(audited.regular.remaining)) answers[at] = is_in_one_step(audited.regular);
  answers[++at] = has_order(audited.regular);
  answers[++at] = has_order(audited.singular);
  answers[++at] = audited.flags.empty();
  return answers;
}

std::string row_html(const Comparison& c, std::size_t s) {
  const OptimizerAxis& axis = c.optimizers[s];
  std::string html = fmt::format(
      "<tr data-s={0}><th scope=row><a href=\"#optimizer-{0}\">{1}{2}</a>{3}<td class=text>{4}", s,
      swatch(axis.method), html_text(optimizer_name(axis)), marks_html(axis),
      kind_title(axis.mathematics()));
  std::array<std::optional<bool>, std::size(kProperties)> answers;
  for (const AuditedOptimizer& audited : c.study->audits)
    if (audited.name == axis.method) answers = answers_of(audited);
  if (!c.study->audits.empty())
    for (const std::optional<bool>& answer : answers)
      html += !answer ? "<td class=none>" : *answer ? "<td class=yes>✓" : "<td class=no>✗";
  return html + fmt::format("<td class=text>{}<td class=text>{}\n",
                            html_text(counted_oracles(c, s)), html_text(joined(axis.privileges)));
}

}  // namespace

std::string properties_html(const Comparison& c, std::size_t s) {
  std::string html;
  for (const AuditedOptimizer& audited : c.study->audits) {
    if (audited.name != c.optimizers[s].method) continue;
    const auto answers = answers_of(audited);
    for (std::size_t i = 0; i < std::size(kProperties); ++i)
      if (answers[i])
        html += fmt::format("<li><b class={}>{}</b> {}: {}</li>", *answers[i] ? "yes" : "no",
                            *answers[i] ? "✓" : "✗", kProperties[i].name, kProperties[i].meaning);
    for (const ConductCell& cell : audited.conduct)
      if (cell.holds)
        html +=
            fmt::format("<li><b class={}>{}</b> {}: {}{}</li>", *cell.holds ? "yes" : "no",
                        *cell.holds ? "✓" : "✗", html_text(cell.column), html_text(cell.figures),
                        *cell.holds ? ""
                                    : html_text(". " + conduct_text(cell.column, "reason") + " " +
                                                conduct_text(cell.column, "advice")));
  }
  return html.empty() ? "" : "<ul class=properties>" + html + "</ul>";
}

std::string methods_html(const Comparison& c) {
  std::string html =
      "<table class=\"grid sortable\" id=methods-table><caption>Methods by rank; select a name for "
      "details</caption><thead><tr><th scope=col>method<th scope=col>kind";
  std::string legend;
  const bool is_measured = !c.study->audits.empty();
  for (const auto& [name, meaning] : kProperties) {
    if (!is_measured) break;
    html += fmt::format("<th scope=col>{}", name);
    add_meaning(legend, name, meaning);
  }
  html +=
      "<th scope=col>required derivatives<th scope=col id=privileges>extra information "
      "(†)<tbody>\n";
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) html += row_html(c, s);
  return "<div class=\"scroll pane\" tabindex=0 role=group aria-label=Methods>" + html +
         "</table></div>" +
         (is_measured ? "<p class=legend>Measured on small problems with known solutions, with "
                        "default options. " +
                            legend + ". Empty: not measured.</p>"
                      : "");
}

}  // namespace isoline::reports
