// A comparison as sentences and tables, which the formats of reports lay out, and as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "core/json.h"
#include "reports/compare/gate.h"
#include "reports/formats/escape.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

const char* change_name(Change change) {
  if (change == Change::changed) return "changed";
  return change == Change::worse ? "worse" : "better";
}

const char* time_change_name(int change) {
  if (change == 0) return "same";
  return change > 0 ? "slower" : "faster";
}

// "+5 %", "12×" for more than tenfold; empty where no ratio says anything.
std::string relative_text(Real relative) {
  constexpr Real kTimes = 9;
  if (relative == 0 || std::abs(relative) == kNever) return "";
  if (relative > kTimes) return fmt::format("{:.3g}×", 1 + relative);
  return fmt::format("{}{:.3g} %", relative > 0 ? "+" : "−", 100 * std::abs(relative));
}

// "+5 %, and 3 more of its kind".
std::string remainder_text(const Difference& difference) {
  const std::string relative = relative_text(difference.relative);
  if (relative.empty() || difference.note.empty()) return relative + difference.note;
  return relative + ", " + difference.note;
}

// "adam, gd", or how many there are.
std::string few_names(const std::set<std::string>& names, const char* noun) {
  constexpr std::size_t kFew = 3;
  if (names.size() > kFew) return counted(names.size(), noun);
  return joined({names.begin(), names.end()});
}

// "3 worse, 2 better"; zero counts are omitted.
std::string counts_text(std::initializer_list<std::pair<std::size_t, std::string>> counts) {
  std::vector<std::string> words;
  for (const auto& [number, word] : counts)
    if (number > 0) words.push_back(fmt::format("{} {}", number, word));
  return joined(words);
}

// "3 cells in both: 3 equal; differences: 1 worse".
std::string summary_text(const GateResult& result) {
  const auto count = [&](Change change) {
    return static_cast<std::size_t>(
        std::ranges::count(result.differences, change, &Difference::change));
  };
  const auto rounded = static_cast<std::size_t>(
      std::ranges::count(result.differences, true, &Difference::is_rounding));
  const std::string cells = counts_text({{result.equal, "equal"},
                                         {result.chaotic, "chaotic"},
                                         {result.incomparable.size(), "not comparable"}});
  const std::string differences = counts_text({{count(Change::worse), "worse"},
                                               {count(Change::better), "better"},
                                               {count(Change::changed), "changed"},
                                               {rounded, "of them by rounding alone"}});
  return fmt::format("{} in both{}{}{}{}", counted(result.joined, "cell"),
                     cells.empty() ? "" : ": ", cells,
                     differences.empty() ? "" : "; differences: ", differences);
}

using Row = std::vector<TableCell>;

// A table without rows is left out.
template <class Value, class ToRow>
void add_table(Section& section, const std::string& title, const std::vector<std::string>& columns,
               const std::string& align, const std::vector<Value>& all, ToRow row) {
  if (all.empty()) return;
  Table table{.title = fmt::format("{} ({})", title, all.size()),
              .columns = columns,
              .align = align,
              .names = columns.size() > 1};
  for (const Value& value : all) table.rows.push_back(row(value));
  section.tables.push_back(std::move(table));
}

Row line(const std::string& text) { return {text}; }
Row reasoned(const ReasonedCell& cell) { return {cell.title, cell.reason}; }

// A table a cause, in the order of the causes; what rounding explains is in none.
void add_differences(Section& section, const GateResult& result) {
  for (const CauseGroup& cause : result.causes) {
    std::vector<Difference> its;
    std::ranges::copy_if(result.differences, std::back_inserter(its), [&](const Difference& one) {
      return one.cause == cause.cause && !one.is_rounding;
    });
    add_table(section, "Differences: " + cause.cause, {"", "cell", "figure", "change"}, "llll", its,
              [](const Difference& one) -> Row {
                return {change_name(one.change), one.title, step_text(one), remainder_text(one)};
              });
  }
}

Row time_row(const TimeVerdict& time) {
  return {time_change_name(time.change),
          time.title,
          ratio_text(time.ratio),
          fmt::format("±{}", percent(time.noise)),
          fmt::format("{:.2g}", time.adjusted),
          fmt::format("{}, {}", time.n_before, time.n_after)};
}

// The verdict is its title; then the counts, the causes and what else must be known.
Section gate_section(const GateResult& result, bool lists_all) {
  constexpr std::size_t kMostCauses = 8;
  Section section{.id = "comparison", .title = "Comparison: " + result.verdict};
  section.readings.push_back({"", summary_text(result) + "."});
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
  add_table(section, "Builds that differ", {"part"}, "", result.builds, line);
  add_table(section, "Options that differ", {"option"}, "", result.settings, line);
  add_table(section, "Time, NEW over BASE",
            {"", "cell", "ratio (95 % interval)", "noise", "p, adjusted", "runs"}, "llrrrr",
            result.times, time_row);
  add_table(section, "In both, with another budget", {"what differs", "cells"}, "ll",
            result.other_terms, [](const CauseGroup& terms) -> Row {
              return {terms.cause, terms.cells_text()};
            });
  add_table(section, "Only in BASE", {"cell"}, "", result.only_before, line);
  add_table(section, "Allowed", {"cell", "reason"}, "ll", result.allowed, reasoned);
  add_table(section, "Not comparable", {"cell", "reason"}, "ll", result.incomparable, reasoned);
  add_table(section, "Only in NEW", {"cell"}, "", result.only_after, line);
  return section;
}

Json to_json(const Difference& d) {
  return {{"change", change_name(d.change)},
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

Json to_json(const TimeVerdict& t) {
  return {{"change", time_change_name(t.change)},
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

Json to_json(const CauseGroup& group) {
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

Json to_json(const ReasonedCell& one) { return {{"title", one.title}, {"reason", one.reason}}; }

template <class Value>
Json json_list(const std::vector<Value>& values) {
  Json list = Json::array();
  for (const Value& value : values) list.push_back(to_json(value));
  return list;
}

}  // namespace

std::string step_text(const Difference& difference) {
  return fmt::format("{} {} → {}", difference.what, difference.before, difference.after);
}

std::string ratio_text(const RatioEstimate& ratio) {
  return fmt::format("{:.3g}× ({:.3g} to {:.3g})", ratio.ratio, ratio.low, ratio.high);
}

std::string names_text(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 12;
  if (names.size() <= kMost) return joined(names);
  return fmt::format("{} and {} more", joined({names.begin(), names.begin() + kMost}),
                     names.size() - kMost);
}

std::string CauseGroup::cells_text() const {
  return fmt::format("{} of {} on {}", counted(cells.size(), "cell"),
                     few_names(optimizers, "optimizer"), few_names(problems, "problem"));
}

std::string cause_group_text(const CauseGroup& group) {
  const std::string rounded =
      fmt::format("different by rounding alone ({:.1e} at most, relative)", group.most_rounding);
  return fmt::format("{}: {}", group.cells_text(),
                     counts_text({{group.worse.size(), "worse"},
                                  {group.better.size(), "better"},
                                  {group.changed.size(), "changed"},
                                  {group.rounded(), rounded},
                                  {group.incomparable, "not comparable"}}));
}

std::string gate_terminal(const GateResult& result, bool lists_all) {
  const Section section = gate_section(result, lists_all);
  return terminal_text(section.title) + "\n\n" +
         terminal_section(section, lists_all ? kAllRows : kFewRows);
}

// The rows of each table that a reader reads.
std::string gate_markdown(const GateResult& result) {
  constexpr std::size_t kMostRows = 40;
  Section section = gate_section(result, false);
  for (Table& table : section.tables) {
    if (table.rows.size() <= kMostRows) continue;
    table.caption =
        fmt::format("{} more are left out here; --json lists them.", table.rows.size() - kMostRows);
    table.rows.resize(kMostRows, {""});
  }
  return markdown_section(section);
}

std::string gate_json(const GateResult& result) {
  Json other_budgets = Json::array();
  for (const CauseGroup& terms : result.other_terms)
    other_budgets.push_back(
        {{"what", terms.cause}, {"cells", terms.cells.size()}, {"optimizers", terms.optimizers}});
  const Json json{{"schema", kComparisonSchema},
                  {"verdict", result.verdict},
                  {"exit_code", static_cast<int>(result.exit_code)},
                  {"joined", result.joined},
                  {"equal", result.equal},
                  {"chaotic", result.chaotic},
                  {"builds", result.builds},
                  {"options", result.settings},
                  {"differences", json_list(result.differences)},
                  {"causes", json_list(result.causes)},
                  {"other_budgets", other_budgets},
                  {"times", json_list(result.times)},
                  {"not_comparable", json_list(result.incomparable)},
                  {"only_in_base", result.only_before},
                  {"allowed", json_list(result.allowed)},
                  {"only_in_new", result.only_after},
                  {"remarks", result.remarks}};
  return json_text(json, 1) + "\n";
}

}  // namespace isoline::reports
