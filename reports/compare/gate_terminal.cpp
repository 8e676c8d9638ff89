// A comparison for the terminal.
#include <fmt/format.h>

#include "reports/compare/gate_words.h"
#include "reports/formats/escape.h"

namespace isoline::reports {
namespace {

std::string section(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string text = fmt::format("\n{} ({})\n", title, lines.size());
  for (const std::string& line : lines) text += "  " + terminal_text(line) + "\n";
  return text;
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

}  // namespace isoline::reports
