// The table of conduct: marks by the rule of each column, with their figures, and what to do at ✗.
#include <fmt/format.h>

#include <algorithm>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string key_of(std::string column) {  // "conduct-own-counter"
  std::ranges::replace(column, ' ', '-');
  return "conduct-" + column;
}

const char* mark_of(const ConductCell& cell) { return !cell.holds ? "–" : *cell.holds ? "✓" : "✗"; }

// Those of a method that was measured.
const std::vector<ConductCell>& columns_of(const Audits& all) {
  return std::ranges::find_if(all, [](const auto& one) { return !one.conduct.empty(); })->conduct;
}

Table rules_table(const Audits& all) {
  Table table = worded_table("conduct-rules");
  for (const ConductCell& column : columns_of(all)) {
    std::array<int, 3> counts{};  // ✓, ✗, –
    for (const AuditedOptimizer& audited : all)
      for (const ConductCell& cell : audited.conduct)
        if (cell.column == column.column) ++counts[!cell.holds ? 2 : *cell.holds ? 0 : 1];
    const std::string key = key_of(column.column);
    table.rows.push_back({column.column, words(key + ".measured"), words(key + ".rule"),
                          words(key + ".advice"),
                          fmt::format("{}, {}, {}", counts[0], counts[1], counts[2])});
  }
  return table;
}

Table marks_table(const Audits& all) {
  Table table = worded_table("conduct-table");
  table.parts = {4, 4, 3};
  table.meanings = {""};
  for (const ConductCell& column : columns_of(all)) {
    table.columns.push_back(column.column);
    table.meanings.push_back(words(key_of(column.column) + ".measured"));
    table.align += 'l';
  }
  for (const AuditedOptimizer& audited : all) {
    if (audited.conduct.empty()) continue;
    auto& row = table.rows.emplace_back();
    row.emplace_back(shown_spec(audited.name));
    for (const ConductCell& cell : audited.conduct) {
      row.emplace_back(fmt::format("{} {}", mark_of(cell), cell.figures));
      row.back().note =
          fmt::format("{}{}", joined(cell.records),
                      cell.holds.value_or(true) ? ""
                                                : "; " + conduct_text(cell.column, "reason") + " " +
                                                      conduct_text(cell.column, "advice"));
    }
    table.row_topics.push_back({.method = audited.name});
  }
  return table;
}

}  // namespace

std::string conduct_text(const std::string& column, const char* part) {
  return words(fmt::format("{}.{}", key_of(column), part));
}

Section conduct_section(const Audits& all) {
  Section section = worded_section("conduct");
  const auto is_measured = [](const AuditedOptimizer& one) { return !one.conduct.empty(); };
  if (std::ranges::none_of(all, is_measured)) return section;
  section.tables = {rules_table(all), marks_table(all)};
  return section;
}

}  // namespace isoline::reports
