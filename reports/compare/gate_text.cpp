// Words for changes, ratios and counts.
#include "reports/compare/gate_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "core/json.h"
#include "reports/compare/pairing.h"
#include "reports/formats/escape.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// "+5 %", "12×" for more than tenfold; empty where no ratio says anything.
std::string relative_text(Real relative) {
  constexpr Real kTimes = 9;
  if (relative == 0 || std::abs(relative) == kNever) return "";
  if (relative > kTimes) return fmt::format("{:.3g}×", 1 + relative);
  return fmt::format("{}{:.3g} %", relative > 0 ? "+" : "−", 100 * std::abs(relative));
}

}  // namespace

const char* name_of(Change change) {
  if (change == Change::changed) return "changed";
  return change == Change::worse ? "worse" : "better";
}

const char* name_of_time(int change) {
  if (change == 0) return "same";
  return change > 0 ? "slower" : "faster";
}

std::string step_text(const Difference& difference) {
  return fmt::format("{} {} → {}", difference.what, difference.before, difference.after);
}

std::string remainder_text(const Difference& difference) {
  const std::string relative = relative_text(difference.relative);
  if (relative.empty() || difference.note.empty()) return relative + difference.note;
  return relative + ", " + difference.note;
}

std::string ratio_text(const RatioEstimate& ratio) {
  return fmt::format("{:.3g}× ({:.3g} to {:.3g})", ratio.ratio, ratio.low, ratio.high);
}

std::string counts_of(const GateResult& result) {
  const auto count = [&](Change change) {
    return static_cast<std::size_t>(
        std::ranges::count(result.differences, change, &Difference::change));
  };
  const auto rounded = static_cast<std::size_t>(
      std::ranges::count(result.differences, true, &Difference::is_rounding));
  const auto text = [](std::initializer_list<std::pair<std::size_t, const char*>> counts) {
    std::vector<std::string> words;
    for (const auto& [number, word] : counts)
      if (number > 0) words.push_back(fmt::format("{} {}", number, word));
    return joined(words);
  };
  const std::string cells = text({{result.equal, "equal"},
                                  {result.chaotic, "chaotic"},
                                  {result.incomparable.size(), "not comparable"}});
  const std::string differences = text({{count(Change::worse), "worse"},
                                        {count(Change::better), "better"},
                                        {count(Change::changed), "changed"},
                                        {rounded, "of them by rounding alone"}});
  return fmt::format("{} in both{}{}{}{}", counted(result.joined, "cell"),
                     cells.empty() ? "" : ": ", cells,
                     differences.empty() ? "" : "; differences: ", differences);
}

// A comparison as a section of tables, which the formats of reports lay out: for the terminal, and
// as Markdown for the summary of a job.

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

// A comparison as JSON, schema isoline.comparison/1.

namespace {

Json json_of(const Difference& d) {
  return {{"change", name_of(d.change)},
          {"cell", d.key},
          {"title", d.title},
          {"optimizer", d.optimizer},
          {"figure", d.what},
          {"before", d.before},
          {"after", d.after},
          {"relative", json_number(d.relative)},
          {"note", d.note},
          {"problem", d.problem},
          {"cause", d.cause},
          {"rounding", d.is_rounding}};
}

Json json_of(const TimeVerdict& t) {
  return {{"change", name_of_time(t.change)},
          {"cell", t.key},
          {"title", t.title},
          {"n", {t.n_before, t.n_after}},
          {"ratio", json_number(t.ratio.ratio)},
          {"low", json_number(t.ratio.low)},
          {"high", json_number(t.ratio.high)},
          {"p", t.p},
          {"adjusted_p", t.adjusted},
          {"noise", json_number(t.noise)}};
}

Json json_of(const DifferenceGroup& g) {
  Json problems = Json::object();
  for (const auto& [name, cells] : g.problems) problems[name] = cells.size();
  return {{"change", name_of(g.change)}, {"cause", g.cause},      {"optimizer", g.optimizer},
          {"problems", problems},        {"cells", g.cells},      {"of", g.of},
          {"figures", g.what},           {"worst", g.worst.title}};
}

Json json_of(const CauseGroup& group) {
  return {{"cause", group.cause},
          {"cells", group.cells.size()},
          {"optimizers", group.optimizers},
          {"problems", group.problems},
          {"worse", group.worse.size()},
          {"better", group.better.size()},
          {"changed", group.changed.size()},
          {"rounding", group.rounded()},
          {"not_comparable", group.incomparable}};
}

Json json_of(const OtherTerms& terms) {
  return {{"what", terms.what}, {"cells", terms.cells}, {"optimizers", terms.optimizers}};
}

Json json_of(const AllowedCell& cell) { return {{"title", cell.title}, {"reason", cell.reason}}; }

Json json_of(const Incomparable& one) { return {{"title", one.title}, {"reason", one.reason}}; }

template <class Value>
Json list_of(const std::vector<Value>& values) {
  Json list = Json::array();
  for (const Value& value : values) list.push_back(json_of(value));
  return list;
}

}  // namespace

std::string gate_json(const GateResult& result) {
  const Json json{{"schema", kComparisonSchema},
                  {"verdict", result.verdict},
                  {"exit_code", static_cast<int>(result.exit_code)},
                  {"joined", result.joined},
                  {"equal", result.equal},
                  {"chaotic", result.chaotic},
                  {"builds", result.builds},
                  {"options", result.settings},
                  {"differences", list_of(result.differences)},
                  {"causes", list_of(result.causes)},
                  {"other_budgets", list_of(result.otherwise)},
                  {"groups", list_of(result.groups)},
                  {"times", list_of(result.times)},
                  {"not_comparable", list_of(result.incomparable)},
                  {"only_in_base", result.only_before},
                  {"allowed", list_of(result.allowed)},
                  {"only_in_new", result.only_after},
                  {"remarks", result.remarks}};
  return json_text(json, 1) + "\n";
}

}  // namespace isoline::reports
