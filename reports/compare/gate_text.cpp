// A comparison as sentences and tables, which the formats of reports lay out, and as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "core/json.h"
#include "reports/compare/gate.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string change_name(Change change) {
  constexpr const char* kNames[] = {"worse", "better", "changed"};
  return kNames[static_cast<std::size_t>(change)];
}

std::string time_change_name(int change) {
  return change == 0 ? "same" : change > 0 ? "slower" : "faster";
}

// "+5 %, and 3 more of its kind"; "12×" for more than tenfold; no ratio where none says anything.
std::string remainder_text(const Difference& difference) {
  constexpr Real kTimes = 9;
  const Real relative = difference.relative;
  if (relative == 0 || std::abs(relative) == kNever) return difference.note;
  const std::string ratio = relative > kTimes ? fmt::format("{:.3g}×", 1 + relative)
                                              : fmt::format("{}{:.3g} %", relative > 0 ? "+" : "−",
                                                            100 * std::abs(relative));
  return ratio + (difference.note.empty() ? "" : ", " + difference.note);
}

// "adam, gd", or how many there are.
std::string few_names(const std::set<std::string>& names, const char* noun) {
  constexpr std::size_t kFew = 3;
  if (names.size() > kFew) return counted(names.size(), noun);
  return joined({names.begin(), names.end()});
}

// "3 worse, 2 better"; zero counts are omitted.
std::string counts_text(std::initializer_list<std::pair<std::size_t, const char*>> counts) {
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
  const std::string cells = counts_text({{result.equal, "equal"},
                                         {result.chaotic, "chaotic"},
                                         {result.incomparable.size(), "not comparable"}});
  const std::string differences = counts_text({{count(Change::worse), "worse"},
                                               {count(Change::better), "better"},
                                               {count(Change::changed), "changed"}});
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

// The verdict is its title; then the counts, the causes and what else must be known. Differences
// have a table a cause, in the order of the causes.
Section gate_section(const GateResult& result, bool lists_all) {
  constexpr std::size_t kMostCauses = 8;
  Section section{.id = "comparison", .title = "Comparison: " + result.verdict};
  const auto say = [&](const char* title, const std::string& text) {
    section.readings.push_back({title, text + "."});
  };
  say("", summary_text(result));
  const std::size_t causes = result.causes.size();
  const std::size_t told = lists_all ? causes : std::min(kMostCauses, causes);
  for (const CauseGroup& cause : std::span(result.causes).first(told))
    say("Cause", fmt::format("{}: {}", cause.cause, cause_group_text(cause)));
  if (told < causes)
    say("", fmt::format("{} more; --all lists them", counted(causes - told, "cause")));
  for (const std::string& remark : result.remarks) say("", remark);
  for (const CauseGroup& cause : result.causes) {
    Differences its;
    std::ranges::copy_if(result.differences, std::back_inserter(its),
                         [&](const Difference& one) { return one.cause == cause.cause; });
    add_table(section, "Differences: " + cause.cause, {"", "cell", "figure", "change"}, "llll", its,
              [](const Difference& one) -> Row {
                return {change_name(one.change),
                        one.title,
                        step_text(one),
                        {remainder_text(one), {{"relative", one.relative}}}};
              });
  }
  add_table(section, "Builds that differ", {"part"}, "", result.builds, line);
  add_table(section, "Options that differ", {"option"}, "", result.settings, line);
  add_table(
      section, "Time, NEW over BASE",
      {"", "cell", "ratio (95 % interval)", "noise", "p, adjusted", "runs"}, "llrrrr", result.times,
      [](const TimeVerdict& time) -> Row {
        return {time_change_name(time.change),
                time.title,
                {ratio_text(time.ratio),
                 {{"ratio", time.ratio.ratio}, {"low", time.ratio.low}, {"high", time.ratio.high}}},
                fmt::format("±{}", percent(time.noise)),
                fmt::format("{:.2g}", time.adjusted),
                fmt::format("{}, {}", time.n_before, time.n_after)};
      });
  add_table(section, "Only in BASE", {"cell"}, "", result.only_before, line);
  add_table(section, "Allowed", {"cell", "reason"}, "ll", result.allowed, reasoned);
  add_table(section, "Not comparable", {"cell", "reason"}, "ll", result.incomparable, reasoned);
  add_table(section, "Only in NEW", {"cell"}, "", result.only_after, line);
  return section;
}

}  // namespace

std::string step_text(const Difference& difference) {
  return fmt::format("{} {} → {}", difference.what, difference.before, difference.after);
}

std::string ratio_text(const RatioEstimate& ratio) {
  return fmt::format("{:.3g}× ({:.3g} to {:.3g})", ratio.ratio, ratio.low, ratio.high);
}

std::string cells_text(const CauseGroup& group) {
  return fmt::format("{} of {} on {}", counted(group.cells.size(), "cell"),
                     few_names(group.optimizers, "optimizer"),
                     few_names(group.problems, "problem"));
}

std::string cause_group_text(const CauseGroup& group) {
  return fmt::format("{}: {}", cells_text(group),
                     counts_text({{group.count(Change::worse), "worse"},
                                  {group.count(Change::better), "better"},
                                  {group.count(Change::changed), "changed"},
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
  Json json = section_json(gate_section(result, true));
  json.update({{"schema", "isoline.comparison/2"},
               {"verdict", result.verdict},
               {"exit_code", static_cast<int>(result.exit_code)},
               {"joined", result.joined},
               {"equal", result.equal},
               {"chaotic", result.chaotic}});
  return json_text(json, 1) + "\n";
}

}  // namespace isoline::reports
