// The outcome of a comparison for the terminal, as Markdown and as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/gate/gate.h"
#include "reports/formats/escape.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

const char* name_of(Change change) {
  if (change == Change::changed) return "changed";
  return change == Change::worse ? "worse" : "better";
}

const char* name_of_time(int change) {
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

std::string remainder_text(const Difference& difference) {
  const std::string relative = relative_text(difference.relative);
  if (relative.empty() || difference.note.empty()) return relative + difference.note;
  return relative + ", " + difference.note;
}

// "1.31× (1.25 to 1.36)": the ratio and its interval.
std::string ratio_text(const RatioEstimate& ratio) {
  return fmt::format("{:.3g}× ({:.3g} to {:.3g})", ratio.ratio, ratio.low, ratio.high);
}

std::string noise_text(const TimeVerdict& time) { return fmt::format("±{}", percent(time.noise)); }

std::string headline_of(const GateResult& result) {
  const auto count = [&](Change change) {
    return std::ranges::count(result.differences, change, &Difference::change);
  };
  return fmt::format(
      "{} cells in both: {} equal, {} not comparable; differences: {} worse, {} better, {} changed",
      result.joined, result.equal, result.incomparable.size(), count(Change::worse),
      count(Change::better), count(Change::changed));
}

constexpr const char* kOnlyBefore = "Only in BASE";
constexpr const char* kOnlyAfter = "Only in NEW";

std::string section(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string text = fmt::format("\n{} ({})\n", title, lines.size());
  for (const std::string& line : lines) text += "  " + terminal_text(line) + "\n";
  return text;
}

std::vector<std::string> lines_of(const std::vector<Incomparable>& all) {
  std::vector<std::string> lines;
  for (const Incomparable& one : all) lines.push_back(one.title + ": " + one.reason);
  return lines;
}

std::string markdown_list(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string text = fmt::format("\n<details><summary>{} ({})</summary>\n\n", title, lines.size());
  for (const std::string& line : lines) text += "- " + markdown_text(line) + "\n";
  return text + "\n</details>\n";
}

std::string markdown_times(const std::vector<TimeVerdict>& times) {
  if (times.empty()) return "";
  std::string text =
      "\n| time | cell | ratio (95 % interval) | noise | p, adjusted | runs |\n"
      "|---|---|---:|---:|---:|---:|\n";
  for (const TimeVerdict& time : times)
    text += fmt::format("| {} | {} | {} | {} | {:.2g} | {}, {} |\n", name_of_time(time.change),
                        markdown_text(time.title), ratio_text(time.ratio), noise_text(time),
                        time.adjusted, time.n_before, time.n_after);
  return text;
}

Json json_of(const Difference& d) {
  return {{"change", name_of(d.change)},
          {"cell", d.key},
          {"title", d.title},
          {"figure", d.what},
          {"before", d.before},
          {"after", d.after},
          {"relative", json_number(d.relative)},
          {"note", d.note}};
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

}  // namespace

std::string gate_terminal(const GateResult& result) {
  std::vector<std::string> differences, times;
  for (const Difference& d : result.differences)
    differences.push_back(fmt::format("{:7} {:48} {}: {} → {}  {}", name_of(d.change), d.title,
                                      d.what, d.before, d.after, remainder_text(d)));
  for (const TimeVerdict& t : result.times)
    times.push_back(fmt::format("{:7} {:48} {}  noise {}  p {:.2g}  n {}, {}",
                                name_of_time(t.change), t.title, ratio_text(t.ratio), noise_text(t),
                                t.adjusted, t.n_before, t.n_after));
  std::string text = headline_of(result) + "\n" + section("Differences", differences) +
                     section("Time, NEW over BASE", times) +
                     section("Not comparable", lines_of(result.incomparable)) +
                     section(kOnlyBefore, result.only_before) +
                     section(kOnlyAfter, result.only_after) + section("Remarks", result.remarks);
  return text + "\n" + result.verdict + "\n";
}

std::string gate_markdown(const GateResult& result) {
  std::string text =
      fmt::format("# Comparison: {}\n\n{}.\n", markdown_text(result.verdict), headline_of(result));
  if (!result.differences.empty())
    text += "\n|  | cell | figure | BASE | NEW | change |\n|---|---|---|---:|---:|---|\n";
  for (const Difference& d : result.differences)
    text +=
        fmt::format("| {} | {} | {} | {} | {} | {} |\n", name_of(d.change), markdown_text(d.title),
                    d.what, markdown_text(d.before), markdown_text(d.after), remainder_text(d));
  text += markdown_times(result.times);
  if (!result.remarks.empty()) text += "\n";
  for (const std::string& remark : result.remarks) text += "- " + markdown_text(remark) + "\n";
  return text + markdown_list("Not comparable", lines_of(result.incomparable)) +
         markdown_list(kOnlyBefore, result.only_before) +
         markdown_list(kOnlyAfter, result.only_after);
}

std::string gate_json(const GateResult& result) {
  Json differences = Json::array(), times = Json::array(), incomparable = Json::array();
  for (const Difference& difference : result.differences)
    differences.push_back(json_of(difference));
  for (const TimeVerdict& time : result.times) times.push_back(json_of(time));
  for (const Incomparable& one : result.incomparable)
    incomparable.push_back({{"title", one.title}, {"reason", one.reason}});
  const Json json{{"schema", kComparisonSchema},
                  {"verdict", result.verdict},
                  {"exit_code", result.exit_code},
                  {"joined", result.joined},
                  {"equal", result.equal},
                  {"differences", differences},
                  {"times", times},
                  {"not_comparable", incomparable},
                  {"only_in_base", result.only_before},
                  {"only_in_new", result.only_after},
                  {"remarks", result.remarks}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace isoline::reports
