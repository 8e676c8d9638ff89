// The report as Markdown, short enough for the summary of a CI job.
#include <fmt/format.h>

#include <ranges>

#include "reports/formats/formats.h"

namespace isoline::reports {
namespace {

std::string cell_text(const TableCell& cell) {
  std::string text = markdown_text(cell.text);
  if (cell.is_best) text = "**" + text + "**";
  if (!cell.remark.empty()) text += fmt::format(" ({})", markdown_text(cell.remark));
  return text;
}

std::string part_text(const Table& table, const Part& part, std::size_t most_rows) {
  const auto line = [&](const auto& of_column) {
    std::string text = "|";
    for (const std::size_t i : part) text += of_column(i);
    return text + "\n";
  };
  std::string text =
      line([&](std::size_t i) { return " " + markdown_text(table.columns[i]) + " |"; });
  text += line([&](std::size_t i) { return table.align_of(i) == 'r' ? "---:|" : "---|"; });
  for (const auto& cells : table.rows | std::views::take(most_rows))
    text += line(
        [&](std::size_t i) { return i < cells.size() ? " " + cell_text(cells[i]) + " |" : ""; });
  return text + "\n";
}

std::string table_text(const Table& table, std::size_t most_rows = kSummaryRows) {
  std::string text;
  if (!table.title.empty()) text += fmt::format("### {}\n\n", markdown_text(table.title));
  if (!table.reading.empty()) text += markdown_text(table.reading) + "\n\n";
  if (table.rows.empty()) return text;
  if (table.is_folded) text += "<details><summary>Table</summary>\n\n";
  const std::size_t most = table.most_columns > 0 ? table.most_columns : table.columns.size();
  Table whole = table;
  whole.parts.clear();
  for (const Part& part : table_parts(whole, most)) text += part_text(table, part, most_rows);
  if (table.rows.size() > most_rows)
    text += fmt::format("{} more rows are in the page.\n\n", table.rows.size() - most_rows);
  for (std::size_t i = 1; i < table.meanings.size(); ++i)
    text +=
        fmt::format("{}: {}. ", markdown_text(table.columns[i]), markdown_text(table.meanings[i]));
  if (!table.caption.empty()) text += markdown_text(table.caption);
  return text + (table.is_folded ? "\n\n</details>\n\n" : "\n\n");
}

}  // namespace

std::string markdown_section(const Section& section, std::size_t most_rows) {
  if (section.is_empty()) return "";
  std::string text = fmt::format("\n## {}\n\n", markdown_text(section.title));
  if (!section.lead.empty()) text += markdown_text(section.lead) + "\n\n";
  for (const Reading& reading : section.readings)
    text += fmt::format(
        "- {}{}\n",
        reading.title.empty() ? "" : fmt::format("**{}:** ", markdown_text(reading.title)),
        markdown_text(reading.text));
  if (!section.readings.empty()) text += "\n";
  for (const Table& table : section.tables) text += table_text(table, most_rows);
  return text;
}

namespace {

// Folded: a summary of a job holds a hundred of them.
std::string claim_text(const Section& claim) {
  std::string text = fmt::format("<details><summary>{}: {}</summary>\n\n", markdown_text(claim.id),
                                 markdown_text(claim.title));
  for (const Reading& reading : claim.readings)
    text +=
        fmt::format("- **{}:** {}\n", markdown_text(reading.title), markdown_text(reading.text));
  if (!claim.command.empty()) text += fmt::format("- **To repeat it:** `{}`\n", claim.command);
  text += "\n";
  for (const Table& table : claim.tables) text += table_text(table);
  return text + "</details>\n\n";
}

}  // namespace

std::string markdown_report(const Document& document) {
  std::string text =
      fmt::format("# Isoline report\n\n{}. Status: {}.\n\n", document.headline, document.statuses);
  if (!document.incomplete.empty())
    text += fmt::format("> **Incomplete: {}**\n\n", markdown_text(document.incomplete));
  for (const std::string& remark : document.remarks)
    text += fmt::format("- {}\n", markdown_text(remark));
  for (const Section& section : document.sections) {
    text += markdown_section(section);
    if (section.id != "claims") continue;
    for (const Judgement& judgement : document.claims) text += claim_text(claim_section(judgement));
  }
  return text;
}

}  // namespace isoline::reports
