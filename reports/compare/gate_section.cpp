// A comparison as a section of tables, which the formats of reports lay out: for the terminal, and
// as Markdown for the summary of a job.
#include <fmt/format.h>

#include <algorithm>

#include "reports/compare/gate_words.h"
#include "reports/formats/escape.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostRows = 40;  // of a table

using Row = std::vector<TableCell>;

// Rows of `all`, as many as a reader reads; a table without rows is left out.
template <class Value, class ToRow>
void add_table(Section& section, Table table, const std::vector<Value>& all, ToRow row) {
  if (all.empty()) return;
  table.title += fmt::format(" ({})", all.size());
  for (std::size_t i = 0; i < std::min(all.size(), kMostRows); ++i)
    table.rows.push_back(row(all[i]));
  if (all.size() > kMostRows)
    table.caption =
        fmt::format("{} more are left out here; --json lists them.", all.size() - kMostRows);
  section.tables.push_back(std::move(table));
}

Row line(const std::string& text) { return {text}; }

Row row_of(const DifferenceGroup& group) {
  std::string others;
  for (std::size_t i = 1; i < group.what.size(); ++i)
    others += (i == 1 ? "also " : ", ") + group.what[i];
  const std::string remainder = remainder_text(group.worst);
  return {name_of(group.change),
          fmt::format("{}: {}", share_text(group.cells, group.of), group.optimizer),
          group.worst.title, step_text(group.worst),
          remainder + (remainder.empty() || others.empty() ? "" : "; ") + others};
}

Row row_of(const TimeVerdict& time) {
  return {name_of_time(time.change),
          time.title,
          ratio_text(time.ratio),
          fmt::format("±{}", percent(time.noise)),
          fmt::format("{:.2g}", time.adjusted),
          fmt::format("{}, {}", time.n_before, time.n_after)};
}

Row row_of(const LackGroup& group) {
  return {fmt::format("{}: {}", share_text(group.cells, group.of), group.optimizer), group.first};
}

Row row_of(const Headline& headline) {
  const auto share = [&](std::size_t t) {
    return fmt::format("{}/{}", headline.solved[t], headline.runs);
  };
  std::string leaders;
  for (const HeadlineMethod& method : headline.leaders)
    leaders += fmt::format("{}{} {}/{} ({})", leaders.empty() ? "" : ", ", method.name,
                           method.solved, method.runs, reached_figure(method.median_work));
  return {headline.label, share(2), share(1), share(0), std::to_string(headline.failed), leaders};
}

void add_what_differs(Section& section, const GateResult& result) {
  add_table(section, {.title = "Builds that differ", .columns = {"part"}, .names = 0},
            result.builds, line);
  add_table(section, {.title = "Options that differ", .columns = {"option"}, .names = 0},
            result.settings, line);
  add_table(section,
            {.title = "Differences by optimizer",
             .columns = {"", "cells", "the largest", "figure", "change"},
             .align = "lllll"},
            result.groups, [](const DifferenceGroup& group) { return row_of(group); });
  add_table(section,
            {.title = "Time, NEW over BASE",
             .columns = {"", "cell", "ratio (95 % interval)", "noise", "p, adjusted", "runs"},
             .align = "llrrrr"},
            result.times, [](const TimeVerdict& time) { return row_of(time); });
}

void add_what_is_apart(Section& section, const GateResult& result) {
  const auto lack = [](const LackGroup& group) { return row_of(group); };
  add_table(
      section,
      {.title = "Only in BASE, by optimizer", .columns = {"cells", "the first"}, .align = "ll"},
      result.lacking, lack);
  add_table(section,
            {.title = "Only in BASE, as allowed", .columns = {"cell", "reason"}, .align = "ll"},
            result.allowed, [](const AllowedCell& cell) -> Row {
              return {cell.title, cell.reason};
            });
  add_table(section, {.title = "Not comparable", .columns = {"cell", "reason"}, .align = "ll"},
            result.incomparable, [](const Incomparable& one) -> Row {
              return {one.title, one.reason};
            });
  add_table(
      section,
      {.title = "Only in NEW, by optimizer", .columns = {"cells", "the first"}, .align = "ll"},
      result.added, lack);
}

Section section_of(const GateResult& result) {
  Section section{.id = "comparison", .title = "Comparison: " + result.verdict};
  section.readings.push_back({"", counts_of(result) + "."});
  for (const std::string& remark : result.remarks) section.readings.push_back({"", remark + "."});
  add_what_differs(section, result);
  add_what_is_apart(section, result);
  add_table(section,
            {.title = "Trend",
             .columns = {"results", "runs that reach 1e-6", "1e-3", "1e-1", "failed",
                         "who solve most (median work)"},
             .align = "lrrrrl"},
            result.trend, [](const Headline& headline) { return row_of(headline); });
  return section;
}

}  // namespace

std::string gate_terminal(const GateResult& result) {
  return terminal_section(section_of(result)) + "\n" + terminal_text(result.verdict) + "\n";
}

std::string gate_markdown(const GateResult& result) { return markdown_section(section_of(result)); }

}  // namespace isoline::reports
