// Words for changes, ratios and counts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "core/json.h"
#include "reports/compare/gate.h"
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

Row time_row(const TimeVerdict& time) {
  return {name_of_time(time.change),
          time.title,
          ratio_text(time.ratio),
          fmt::format("±{}", percent(time.noise)),
          fmt::format("{:.2g}", time.adjusted),
          fmt::format("{}, {}", time.n_before, time.n_after)};
}

// A table a cause, in the order of the causes; what rounding explains is in none.
void add_differences(Section& section, const GateResult& result) {
  for (const CauseGroup& cause : result.causes) {
    std::vector<Difference> its;
    std::ranges::copy_if(result.differences, std::back_inserter(its), [&](const Difference& one) {
      return one.cause == cause.cause && !one.is_rounding;
    });
    add_table(section,
              {.title = "Differences: " + cause.cause,
               .columns = {"", "cell", "figure", "change"},
               .align = "llll"},
              its, [](const Difference& one) -> Row {
                return {name_of(one.change), one.title, step_text(one), remainder_text(one)};
              });
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
            result.times, [](const TimeVerdict& time) { return time_row(time); });
}

void add_what_is_apart(Section& section, const GateResult& result) {
  add_table(section,
            {.title = "In both, with another budget",
             .columns = {"what differs", "cells"},
             .align = "ll"},
            result.other_terms, [](const OtherTerms& terms) -> Row {
              return {terms.what,
                      fmt::format("{} of {}", counted(terms.cells, "cell"),
                                  names_text({terms.optimizers.begin(), terms.optimizers.end()}))};
            });
  add_table(section, {.title = "Only in BASE", .columns = {"cell"}}, result.only_before, line);
  add_table(section,
            {.title = "Only in BASE, as allowed", .columns = {"cell", "reason"}, .align = "ll"},
            result.allowed, [](const AllowedCell& cell) -> Row {
              return {cell.title, cell.reason};
            });
  add_table(section, {.title = "Not comparable", .columns = {"cell", "reason"}, .align = "ll"},
            result.incomparable, [](const Incomparable& pair) -> Row {
              return {pair.title, pair.reason};
            });
  add_table(section, {.title = "Only in NEW", .columns = {"cell"}}, result.only_after, line);
}

// The verdict is its title; then the counts, the causes and what else must be known.
Section section_of(const GateResult& result, bool lists_all) {
  constexpr std::size_t kMostCauses = 8;
  Section section{.id = "comparison", .title = "Comparison: " + result.verdict};
  section.readings.push_back({"", counts_of(result) + "."});
  const std::size_t told =
      lists_all ? result.causes.size() : std::min(kMostCauses, result.causes.size());
  for (const CauseGroup& cause : std::span(result.causes).first(told))
    section.readings.push_back(
        {"Cause", fmt::format("{}: {}.", cause.cause, cause_group_text(cause))});
  if (told < result.causes.size())
    section.readings.push_back({"", fmt::format("{} more; --all lists them.",
                                                counted(result.causes.size() - told, "cause"))});
  for (const std::string& remark : result.remarks) section.readings.push_back({"", remark + "."});
  add_differences(section, result);
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
                  {"other_budgets", list_of(result.other_terms)},
                  {"times", list_of(result.times)},
                  {"not_comparable", list_of(result.incomparable)},
                  {"only_in_base", result.only_before},
                  {"allowed", list_of(result.allowed)},
                  {"only_in_new", result.only_after},
                  {"remarks", result.remarks}};
  return json_text(json, 1) + "\n";
}

}  // namespace isoline::reports
