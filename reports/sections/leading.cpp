// Pairs over the problems that both were given.
#include "reports/sections/leading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reports/read/ranking.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::vector<MethodPair> all_pairs(const Comparison& c) {
  Costs costs = median_costs(c, kTightest);
  for (std::size_t p = 0; p < costs.size(); ++p)
    if (!is_ordered(c, p)) costs[p].assign(costs[p].size(), std::nullopt);
  const Groups groups = groups_of(c);
  std::vector<MethodPair> all;
  for (std::size_t a = 0; a < c.optimizers.size(); ++a)
    for (std::size_t b = a + 1; b < c.optimizers.size(); ++b)
      all.push_back({a, b, pairing_of(costs, groups, a, b)});
  return all;
}

// Words for leads.

namespace {

// The first in rank that cannot be told from the leader by itself; the next where all can be.
const Rival& nearest(const Lead& lead) {
  const auto open = std::ranges::find_if(lead.rivals, [](const Rival& rival) {
    return rival.p > kSignificant || rival.pairing.doublings.size() < kLeastNames;
  });
  return open == lead.rivals.end() ? lead.rivals.front() : *open;
}

// log2 of the other's cost over the first's, the mean over problems.
Real mean_doublings(const Pairing& pairing) {
  const auto& all = pairing.doublings;
  return -std::accumulate(all.begin(), all.end(), 0.0) / std::max(Real(all.size()), 1.0);
}

bool solves_none(const Comparison& c, const Placed& placed) {
  const Standing& standing = c.optimizers[placed.optimizer].tightest();
  return standing.solved == 0 && standing.settings > 0;
}

std::string given_text(const OptimizerAxis& axis) {
  return axis.label == axis.whole ? "where it has no privileged information"
                                  : "where it is " + axis.label.substr(axis.whole.size() + 2);
}

// "17 settings of 15 problems", or "15 problems" where each has one.
std::string ground_text(const Comparison& c, const Order& order) {
  const std::size_t names = names_of(c, order);
  if (names == order.settings.size()) return counted(names, "problem");
  return fmt::format("{} of {}", counted(order.settings.size(), "setting"),
                     counted(names, "problem"));
}

}  // namespace

std::string field_text(const Comparison& c, const Lead& lead) {
  return fmt::format("{} on the {} that all of them were given",
                     counted(lead.ranked.size(), "method"), ground_text(c, c.order));
}

std::string deeds_text(const Comparison& c, const Scored& scored) {
  return fmt::format("solves {} of {} to {}, {} of them with the least {}", scored.solved,
                     counted(scored.problems, common_noun(c)), tau_name(c), scored.wins,
                     counted_name(c));
}

std::string first_text(const Comparison& c, const Lead& lead) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < lead.tied; ++i)
    names.push_back(optimizer_text(c, lead.ranked[i].optimizer));
  if (names.size() > kNamed) return fmt::format("{} and {} others", names[0], names.size() - 1);
  return joined(names, " and ");
}

std::string pairing_text(const Comparison& c, const Pairing& pairing, std::size_t first) {
  return fmt::format("typically takes {} the {} of {}, which needs less on {} of {} and more on {}",
                     multiple(pairing.typical()), counted_name(c), optimizer_text(c, first),
                     pairing.wins, counted(pairing.doublings.size(), "problem"), pairing.losses);
}

std::string settled_text(const Comparison& c, const Lead& lead) {
  if (lead.tied > 1)
    return fmt::format("{} are tied: the scores are equal, and none leads.", first_text(c, lead));
  if (lead.rivals.empty()) return "There is no other method to compare it with.";
  const Rival& rival = nearest(lead);
  const std::string name = optimizer_text(c, rival.optimizer);
  const std::string pairing = pairing_text(c, rival.pairing, lead.ranked[0].optimizer);
  if (lead.is_settled)
    return fmt::format(
        "Its lead is settled for problems like these: each of the {} others is behind at 0.05 by a "
        "paired sign-flip test over problems; the next, {}, {}.",
        lead.rivals.size(), name, pairing);
  if (rival.pairing.doublings.size() < kLeastNames)
    return fmt::format(
        "Its lead is not settled: against {} there are {} to compare, and the test asks for {}; {} "
        "{}.",
        name, counted(rival.pairing.doublings.size(), "problem"), kLeastNames, name, pairing);
  if (rival.p <= kSignificant)
    return "Its lead is not settled: the ranks of all methods together could be chance.";
  const Real mean = mean_doublings(rival.pairing);
  const std::string favoured =
      mean > 0 ? optimizer_text(c, lead.ranked[0].optimizer) : optimizer_text(c, rival.optimizer);
  return fmt::format(
      "Its lead is not settled: {} is not distinguishable from it, since the mean over problems is {:.2g} "
      "doublings in favour of {} (p = {:.2g} by a paired sign-flip test); {} {}.",
      name, std::abs(mean), favoured, rival.p, name, pairing);
}

std::string power_text(const Comparison& c, const Lead& lead) {
  if (lead.rivals.empty()) return "";
  const Rival& rival = nearest(lead);
  const Real factor = detectable_factor(rival.pairing);
  std::string text = fmt::format(
      "After Holm, {} of the {} others that apply to at least half of these problems {} told from {}.",
      lead.told(), lead.rivals.size(), lead.told() == 1 ? "is" : "are",
      optimizer_text(c, lead.ranked[0].optimizer));
  if (factor < kNever && factor > 1)
    text += fmt::format(
        " With the spread there is against {} over {}, a true factor of {} would be found in 80 % "
        "of such comparisons.",
        optimizer_text(c, rival.optimizer), counted(rival.pairing.doublings.size(), "problem"),
        multiple(factor));
  return text;
}

std::string placed_text(const Comparison& c, const Placed& placed) {
  const OptimizerAxis& axis = c.optimizers[placed.optimizer];
  const std::string settings = counted(placed.among.settings.size(), setting_noun(c));
  if (solves_none(c, placed)) {
    const std::string those = placed.among.settings.size() == 1
                                  ? "does not solve the one " + std::string(setting_noun(c))
                                  : "solves none of the " + settings;
    return those + (axis.is_meaning ? " " + given_text(axis) : " it was given");
  }
  if (placed.among.methods.size() < 2)
    return fmt::format("alone on {}", counted(placed.among.settings.size(), setting_noun(c)));
  return fmt::format("{} of {} on the {}{}", ordinal(placed.place), placed.among.methods.size(),
                     settings, axis.is_meaning ? " " + given_text(axis) : " it was given");
}

std::string apart_text(const Comparison& c, const Placed& placed) {
  const OptimizerAxis& axis = c.optimizers[placed.optimizer];
  if (axis.is_meaning) return "has privileged information on some problems only";
  return fmt::format("asked {} of {}", placed.asked, counted(placed.shared, setting_noun(c)));
}

std::string apart_sentence(const Comparison& c) {
  std::vector<std::string> meanings, others;
  for (const Placed& placed : c.apart) {
    const std::string name = shown_spec(c.optimizers[placed.optimizer].label);
    if (c.optimizers[placed.optimizer].is_meaning)
      meanings.push_back(fmt::format("{} {}{}", name, solves_none(c, placed) ? "" : "is ",
                                     placed_text(c, placed)));
    else
      others.push_back(fmt::format("{} ({})", name, apart_text(c, placed)));
  }
  std::string text;
  if (!meanings.empty())
    text +=
        fmt::format("Listed apart, since it has privileged information on some problems only: {}.",
                    joined(meanings, "; "));
  if (!others.empty())
    text += fmt::format("{}Not ranked: {}.", text.empty() ? "" : " ", joined(others));
  return text;
}

}  // namespace isoline::reports
