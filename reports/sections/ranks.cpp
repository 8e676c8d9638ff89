// The leader against each other method, and what so few problems cannot show.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "reports/read/grounds.h"
#include "reports/read/orders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/leading.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/words.h"
#include "reports/statistics/rank_tests.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {}  // namespace

Table leader_table(const Comparison& c) {
  Table table{
      .id = "leader",
      .title = "The leader against each of the others",
      .reading = "There is no leader.",
      .caption = fmt::format(
          "One doubling a problem: log2 of the ratio of median {} to {}, the median over its "
          "settings, within ±6, which is also what solving against not solving counts. × of the "
          "leader: 2 to the median of them. p: exact two-sided paired sign flips of their mean; "
          "after Holm over all methods here. A problem that neither solves is left out; so is a "
          "method that applies to fewer than half of the settings.",
          counted_name(c), tau_name(c)),
      .columns = {"optimizer", "× of the leader", "wins : losses", "p", "after Holm", "n problems",
                  "failed"},
      .rows = {}};
  if (!c.lead) return table;
  const Lead& lead = *c.lead;
  for (const Rival& rival : lead.rivals) {
    if (table.rows.size() >= kMostTableRows) break;
    const Pairing& pairing = rival.pairing;
    table.row_topics.push_back({.optimizer = rival.optimizer});
    table.rows.push_back(
        {optimizer_text(c, rival.optimizer),
         {fmt::format("{:.3g}", pairing.typical()), {{"ratio", pairing.typical()}}},
         {fmt::format("{} : {}", pairing.wins, pairing.losses),
          {{"wins", Real(pairing.wins)}, {"losses", Real(pairing.losses)}}},
         {fmt::format("{:.2g}", rival.p), {{"p", rival.p}}},
         {fmt::format("{:.2g}", rival.adjusted), {{"adjusted_p", rival.adjusted}}},
         count_cell(pairing.doublings.size()),
         failed_cell(c, rival.optimizer)});
  }
  table.reading = settled_text(c, lead) + " " + power_text(c, lead);
  return table;
}

std::vector<std::string> limits_of_evidence(const Comparison& c) {
  std::vector<std::string> all;
  const std::size_t k = c.order.methods.size(), names = names_of(c, c.order);
  if (k < 2 || names == 0) return all;
  const Real friedman = friedman_of(c);
  all.push_back(fmt::format(
      "Friedman’s test of {} over the {} given to all of them: p = {:.2g}, so {}.",
      counted(k, "method"), counted(names, "problem"), friedman,
      friedman <= kSignificant ? "the mean ranks differ" : "equal mean ranks cannot be ruled out"));
  if (c.lead && !c.lead->rivals.empty()) {
    const Real pairs = Real(c.lead->rivals.size()),
               least = std::min(1.0, std::exp2(1 - Real(names)));
    all.push_back(power_text(c, *c.lead));
    all.push_back(fmt::format(
        "Over {} the least p that sign flips can give is {:.2g}, after Holm over the leader’s {} "
        "pairs {:.2g}{}.",
        counted(names, "problem"), least, pairs, std::min(1.0, least * pairs),
        least * pairs > kSignificant ? ": no pair can be told apart after it, whatever the results"
                                     : ""));
  }
  if (c.seeds.size() < kFewestForInterval)
    all.push_back(
        fmt::format("With {} no interval over seeds reaches 95 %: ranges are shown instead.",
                    counted(c.seeds.size(), "seed")));
  all.push_back("Nothing here speaks for problems unlike these: they were chosen, not drawn.");
  return all;
}

}  // namespace isoline::reports
