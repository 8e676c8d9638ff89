// The sentences of an advice: which method suits a reader's means.
#include "core/results/advice.h"

#include <algorithm>
#include <set>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kFewestFamilies = 6, kFewestSolved = 3;  // for a recommendation

// The goal of these settings: "1e-6", or what replaces it on all or some of them.
std::string goal_of(const Comparison& c, const std::vector<std::size_t>& settings) {
  const auto is_fit = [&](std::size_t p) { return is_judged_by_fit(c, p); };
  const auto fits = static_cast<std::size_t>(std::ranges::count_if(settings, is_fit));
  if (fits == 0) return tau_name(c);
  return fits == settings.size() ? words("advice.fit") : words("advice.some-fit", tau_name(c));
}

}  // namespace

std::string means_text(const Means& means) {
  std::string text =
      words("means." + std::string(kDerivativeNames[std::size_t(means.derivatives)]));
  if (means.has_inverse) text += words("means.inverse");
  const bool is_bounded = means.most_unknowns < Means{}.most_unknowns;
  if (is_bounded && means.least_unknowns > 0)
    text += words("means.between", means.least_unknowns, means.most_unknowns);
  else if (is_bounded)
    text += words("means.most", means.most_unknowns);
  else if (means.least_unknowns > 0)
    text += words("means.least", means.least_unknowns);
  if (means.noise > 0) text += words("means.noise", 100 * means.noise);
  if (means.has_bounds) text += words("means.bounds");
  if (means.has_failures) text += words("means.failures");
  return means.budget < kNever ? text + words("means.budget", means.budget) : text;
}

std::string advised_name(const Comparison& c, const Advised& one) {
  const std::string name = c.optimizers[one.optimizer].name_of_all();
  std::set<std::string> specs;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    if (c.optimizers[s].name_of_all() != name) continue;
    for (const auto& cells : c.cells) {
      if (cells[s].runs.empty()) continue;
      const Component& asked = c.runs[cells[s].runs[0]].record->request.optimizer;
      specs.insert(asked.asked.empty() ? asked.spec : asked.asked);
    }
  }
  return shown_spec(specs.size() == 1 && !c.optimizers[one.optimizer].is_meaning ? *specs.begin()
                                                                                 : name);
}

std::string advice_text(const Comparison& c, const Means& means, const Advice& advice) {
  const auto name = [&](const Advised& one) { return advised_name(c, one); };
  std::set<std::string> families;
  for (const std::size_t p : advice.settings) families.insert(c.problems[p].family());
  std::size_t physics = 0;
  for (const std::size_t p : advice.settings) physics += c.problems[p].group() == "physics";
  std::string text;
  const std::string goal = goal_of(c, advice.settings);
  const auto missing = std::ranges::count_if(c.absent, [&](const Run& run) {
    return std::ranges::find(advice.settings, run.problem) != advice.settings.end();
  });
  if (advice.settings.empty()) {
    text = words("advice.no-settings", means_text(means));
  } else if (missing > 0) {
    text = words("advice.incomplete", means_text(means), missing);
  } else if (advice.ranked.empty()) {
    text = words("advice.none", means_text(means), goal, advice.settings.size());
    const auto is_unknown = [&](std::size_t p) { return c.problems[p].lacks_least_loss(); };
    const auto unknown = std::ranges::count_if(advice.settings, is_unknown);
    if (unknown > 0) text += " " + words("advice.unknown", unknown);
  } else if (families.size() < kFewestFamilies || advice.ranked[0].solved < kFewestSolved) {
    const Advised& first = advice.ranked[0];
    text = words("advice.too-few", means_text(means), families.size(), advice.settings.size(),
                 name(first), first.solved, goal, kFewestFamilies, kFewestSolved);
  } else {
    const Advised& first = advice.ranked[0];
    std::vector<std::string> equal{name(first)}, group;  // that solve no fewer; other ones
    for (const Advised& one : advice.ranked) {
      if (!one.is_in_group || &one == &first) continue;
      if (one.solved >= first.solved)
        equal.push_back(name(one));
      else
        group.push_back(words("advice.member", name(one), one.solved));
    }
    const auto as_many = std::ranges::count(advice.ranked, first.solved, &Advised::solved);
    if (advice.settings.size() < kFewestForInterval && as_many > 1) {
      text = words("advice.indistinct", means_text(means), advice.settings.size(), goal, as_many,
                   advice.ranked.size(), first.solved);
    } else {
      text = words(equal.size() > 1 ? "advice.equal" : "advice.first", means_text(means),
                   first_of(equal, 4, " or "), first.solved, advice.settings.size(), physics, goal);
      if (first.work < kNever) text += " " + words("advice.work", name(first), figure(first.work));
      if (advice.ranked.size() == 1)
        text += " " + words("advice.only");
      else if (!group.empty())
        text += " " + words("advice.group", first_of(std::move(group), 3));
      else if (equal.size() == 1)
        text += " " + words("advice.alone", advice.ranked.size());
    }
  }
  if (advice.settings.size() < advice.of_size)
    text += " " + words("advice.shared", advice.settings.size(), advice.of_size);
  std::vector<std::string> partial;
  for (const Advised& one : advice.partial)
    partial.push_back(words("advice.on", name(one), one.settings, one.solved));
  return partial.empty() ? text
                         : text + " " + words("advice.partial", first_of(std::move(partial), 3));
}

}  // namespace isoline::reports
