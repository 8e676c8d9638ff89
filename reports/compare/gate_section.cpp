// A comparison as a section of tables, which the formats of reports lay out: for the terminal, and
// as Markdown for the summary of a job.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>

#include "reports/compare/changes.h"
#include "reports/compare/gate_words.h"
#include "reports/formats/escape.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostRows = 40;  // of a table

using Row = std::vector<TableCell>;

// A table without rows is left out.
template <class Value, class ToRow>
void add_table(Section& section, Table table, const std::vector<Value>& all, ToRow row) {
  if (all.empty()) return;
  table.title += fmt::format(" ({})", all.size());
  for (const Value& value : all) table.rows.push_back(row(value));
  section.tables.push_back(std::move(table));
}

// Of each table as many rows as a reader reads.
void cut(Section& section) {
  for (Table& table : section.tables) {
    if (table.rows.size() <= kMostRows) continue;
    table.caption =
        fmt::format("{} more are left out here; --json lists them.", table.rows.size() - kMostRows);
    table.rows.resize(kMostRows, {""});
  }
}

Row line(const std::string& text) { return {text}; }

// "sine 3, heat", those with most cells first, or how many there are.
std::string problems_text(const DifferenceGroup& group) {
  constexpr std::size_t kMost = 3;
  std::vector<std::pair<std::size_t, std::string>> all;
  for (const auto& [name, cells] : group.problems) all.emplace_back(cells.size(), name);
  std::ranges::stable_sort(all, std::greater(), [](const auto& each) { return each.first; });
  std::vector<std::string> names;
  for (const auto& [cells, name] : all)
    if (names.size() < kMost)
      names.push_back(cells == 1 ? name : fmt::format("{} {}", name, cells));
  const std::string more =
      all.size() > kMost ? fmt::format(" and {} more", all.size() - kMost) : "";
  return joined(names) + more;
}

Row row_of(const DifferenceGroup& group) {
  std::string others;
  for (std::size_t i = 1; i < group.what.size(); ++i)
    others += (i == 1 ? "also " : ", ") + group.what[i];
  const std::string remainder = remainder_text(group.worst);
  const std::string cells =
      group.of == 0 ? std::to_string(group.cells) : share_text(group.cells, group.of);
  return {name_of(group.change),
          fmt::format("{}: {}", cells, group.optimizer),
          problems_text(group),
          group.worst.title,
          step_text(group.worst),
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
  return {fmt::format("{}: {}", share_text(group.cells, group.of), group.optimizer),
          names_text({group.problems.begin(), group.problems.end()}), group.first};
}

Row row_of(const OtherTerms& terms) {
  return {terms.what,
          fmt::format("{} of {}", counted(terms.cells, "cell"),
                      names_text({terms.optimizers.begin(), terms.optimizers.end()})),
          terms.first};
}

// What cannot be compared for one reason, by optimizer.
struct IncomparableGroup {
  std::string optimizer, first;
  std::set<std::string> problems;
  std::size_t cells = 0;
};

std::vector<IncomparableGroup> incomparable_for(const std::string& reason,
                                                const std::vector<Incomparable>& all) {
  std::map<std::string, IncomparableGroup> groups;
  for (const Incomparable& pair : all) {
    if (pair.reason != reason) continue;
    IncomparableGroup& group = groups[pair.optimizer];
    if (group.cells++ == 0) group.first = pair.title;
    group.optimizer = pair.optimizer;
    group.problems.insert(pair.problem);
  }
  std::vector<IncomparableGroup> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

Row row_of(const IncomparableGroup& group) {
  return {fmt::format("{}: {}", group.cells, group.optimizer),
          names_text({group.problems.begin(), group.problems.end()}), group.first};
}

// A table a cause, in the order of the causes.
void add_differences(Section& section, const GateResult& result,
                     const std::vector<DifferenceGroup>& groups) {
  for (const CauseGroup& cause : result.causes) {
    std::vector<DifferenceGroup> its;
    std::ranges::copy_if(groups, std::back_inserter(its),
                         [&](const DifferenceGroup& group) { return group.cause == cause.cause; });
    add_table(section,
              {.title = "Differences: " + cause.cause,
               .columns = {"", "cells", "problems", "the largest", "figure", "change"},
               .align = "llllll"},
              its, [](const DifferenceGroup& group) { return row_of(group); });
  }
}

void add_what_differs(Section& section, const GateResult& result) {
  add_table(section, {.title = "Builds that differ", .columns = {"part"}, .names = 0},
            result.builds, line);
  add_table(section, {.title = "Options that differ", .columns = {"option"}, .names = 0},
            result.settings, line);
  add_table(section,
            {.title = "Time, NEW over BASE",
             .columns = {"", "cell", "ratio (95 % interval)", "noise", "p, adjusted", "runs"},
             .align = "llrrrr"},
            result.times, [](const TimeVerdict& time) { return row_of(time); });
}

void add_what_is_apart(Section& section, const GateResult& result) {
  const auto lack = [](const LackGroup& group) { return row_of(group); };
  add_table(section,
            {.title = "In both, with another budget",
             .columns = {"what differs", "cells", "the first"},
             .align = "lll"},
            result.otherwise, [](const OtherTerms& terms) { return row_of(terms); });
  add_table(section,
            {.title = "Only in BASE, by optimizer",
             .columns = {"cells", "problems", "the first"},
             .align = "lll"},
            result.lacking, lack);
  add_table(section,
            {.title = "Only in BASE, as allowed", .columns = {"cell", "reason"}, .align = "ll"},
            result.allowed, [](const AllowedCell& cell) -> Row {
              return {cell.title, cell.reason};
            });
  for (const CauseGroup& cause : result.causes)
    add_table(section,
              {.title = "Not comparable: " + cause.cause,
               .columns = {"cells", "problems", "the first"},
               .align = "lll"},
              incomparable_for(cause.cause, result.incomparable),
              [](const IncomparableGroup& group) { return row_of(group); });
  add_table(section,
            {.title = "Only in NEW, by optimizer",
             .columns = {"cells", "problems", "the first"},
             .align = "lll"},
            result.added, lack);
}

// The verdict is its title; then the counts, the causes and what else must be known.
Section section_of(const GateResult& result, bool lists_all) {
  constexpr std::size_t kMostCauses = 8;
  Section section{.id = "comparison", .title = "Comparison: " + result.verdict};
  section.readings.push_back({"", counts_of(result) + "."});
  const std::size_t told =
      lists_all ? result.causes.size() : std::min(kMostCauses, result.causes.size());
  for (const CauseGroup& cause : std::span(result.causes).first(told))
    section.readings.push_back({"Cause", fmt::format("{}: {}.", cause.cause, words_of(cause))});
  if (told < result.causes.size())
    section.readings.push_back({"", fmt::format("{} more; --all lists them.",
                                                counted(result.causes.size() - told, "cause"))});
  for (const std::string& remark : result.remarks) section.readings.push_back({"", remark + "."});
  add_differences(section, result,
                  lists_all ? grouped_by_problem(result.differences) : result.groups);
  add_what_differs(section, result);
  add_what_is_apart(section, result);
  return section;
}

}  // namespace

std::string gate_terminal(const GateResult& result, bool lists_all) {
  const Section section = section_of(result, lists_all);
  return terminal_text(section.title) + "\n\n" +
         terminal_section(section, lists_all ? kAllRows : kFewRows);
}

std::string gate_markdown(const GateResult& result) {
  Section section = section_of(result, false);
  cut(section);
  return markdown_section(section);
}

}  // namespace isoline::reports
