// Whether the order of methods holds at declared and at measured prices.
#include <fmt/format.h>

#include <algorithm>

#include "reports/read/grounds.h"
#include "reports/read/leaders.h"
#include "reports/sections/leading.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kFirst = 3;

// The first three by score, at the prices of one measure.
std::vector<std::string> first_by(const Comparison& c, Measure by) {
  std::vector<std::string> names;
  const auto lead = lead_of(c, false, by);
  if (!lead) return names;
  for (std::size_t i = 0; i < std::min(kFirst, lead->ranked.size()); ++i)
    if (lead->ranked[i].score > 0) names.push_back(optimizer_text(c, lead->ranked[i].optimizer));
  return names;
}

}  // namespace

std::string prices_text(const Comparison& c) {
  if (c.yardstick.by == Measure::time && c.is_any_timed_together)
    return "Some of these times were taken while other runs shared the machine, and are marked ≈: an "
           "order by them is no evidence. Runs with --exclusive are timed alone.";
  const bool is_by_calls = c.yardstick.by == Measure::work || c.yardstick.by == Measure::cost;
  if (!is_by_calls || !has_order(c)) return "";
  const auto priced = static_cast<std::size_t>(std::ranges::count_if(
      c.order.settings, [&](std::size_t p) { return c.problems[p].prices.are_measured(); }));
  if (priced == 0)
    return "These results cannot say whether the order holds at measured prices: none was measured "
           "here, or calls are too short to be.";
  const std::vector<std::string> declared = first_by(c, Measure::work),
                                 measured = first_by(c, Measure::cost);
  if (declared.empty() && measured.empty()) return "";
  const std::string where = fmt::format("measured prices (told on {} of {}, declared elsewhere)",
                                        priced, counted(c.order.settings.size(), common_noun(c)));
  if (declared == measured)
    return fmt::format("At declared prices and at {} the first are the same: {}.", where,
                       joined(declared));
  const bool is_same_first = !declared.empty() && !measured.empty() && declared[0] == measured[0];
  return fmt::format("The order {} at both prices: at declared ones the first are {}; at {}, {}.",
                     is_same_first ? "below the first does not hold" : "does not hold",
                     joined(declared), where, joined(measured));
}

}  // namespace isoline::reports
