// Words for changes, ratios and counts.
#include "reports/compare/gate_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

}  // namespace isoline::reports
