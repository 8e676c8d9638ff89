// Gathers differences by cause, and cells that were asked with other budgets.
#include "reports/compare/causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "core/json.h"
#include "reports/sections/words.h"

namespace isoline::reports {

namespace {

CauseGroup& group_of(std::vector<CauseGroup>& groups, const std::string& cause) {
  const auto at = std::ranges::find(groups, cause, &CauseGroup::cause);
  if (at != groups.end()) return *at;
  groups.emplace_back().cause = cause;
  return groups.back();
}

void count(CauseGroup& group, const Difference& difference) {
  if (difference.is_rounding) {
    group.most_rounding = std::max(group.most_rounding, std::abs(difference.relative));
    return;
  }
  switch (difference.change) {
    case Change::worse:
      group.worse.insert(difference.key);
      break;
    case Change::better:
      group.better.insert(difference.key);
      break;
    case Change::changed:
      group.changed.insert(difference.key);
  }
}

template <class Cell>
void add_cell(CauseGroup& group, const Cell& cell) {
  group.cells.insert(cell.key);
  group.problems.insert(cell.problem);
  group.optimizers.insert(cell.optimizer);
}

// "adam and gd", or how many there are.
std::string few_names(const std::set<std::string>& names, const char* noun) {
  constexpr std::size_t kFew = 3;
  if (names.size() > kFew) return counted(names.size(), noun);
  return joined({names.begin(), names.end()});
}

// The members of the budget in "seed 0, budget {"iterations":20}, threads 1", and the threads.
Json terms_json(const std::string& terms) {
  const std::size_t begin = terms.find('{'), end = terms.rfind('}');
  if (begin == std::string::npos || end == std::string::npos) return Json::object();
  Json json = Json::parse(terms.substr(begin, end - begin + 1), nullptr, false);
  if (!json.is_object()) return Json::object();
  json["threads"] = Json::parse(terms.substr(terms.rfind(' ') + 1), nullptr, false);
  return json;
}

// "iterations 20 → 30"; empty where nothing but the seed differs.
std::string change_of_terms(const Subject& before, const Subject& after) {
  const Json old = terms_json(before.terms), now = terms_json(after.terms);
  std::set<std::string> keys;
  for (const Json* terms : {&old, &now})
    for (const auto& [key, value] : terms->items()) keys.insert(key);
  const auto value_text = [](const Json& terms, const std::string& key) {
    return terms.contains(key) ? json_text(terms.at(key)) : std::string("no limit");
  };
  std::vector<std::string> changes;
  for (const std::string& key : keys)
    if (const auto was = value_text(old, key), is = value_text(now, key); was != is)
      changes.push_back(fmt::format("{} {} → {}", key, was, is));
  return joined(changes);
}

}  // namespace

std::size_t CauseGroup::rounded() const {
  std::set<std::string> others = worse;
  for (const auto* some : {&better, &changed}) others.insert(some->begin(), some->end());
  return cells.size() - others.size() - incomparable;
}

std::vector<CauseGroup> caused(const std::vector<Difference>& differences,
                               const std::vector<Incomparable>& incomparable) {
  std::vector<CauseGroup> groups;
  for (const Difference& difference : differences) {
    CauseGroup& group = group_of(groups, difference.cause);
    add_cell(group, difference);
    count(group, difference);
  }
  for (const Incomparable& pair : incomparable) {
    CauseGroup& group = group_of(groups, pair.reason);
    add_cell(group, pair);
    ++group.incomparable;
  }
  std::ranges::stable_sort(groups, std::greater(), [](const CauseGroup& group) {
    return std::tuple(!group.worse.empty(), group.incomparable > 0, group.cells.size());
  });
  return groups;
}

std::string cause_group_text(const CauseGroup& group) {
  std::vector<std::string> parts;
  const auto add = [&](std::size_t cells, const std::string& word) {
    if (cells > 0) parts.push_back(fmt::format("{} {}", cells, word));
  };
  add(group.worse.size(), "worse");
  add(group.better.size(), "better");
  add(group.changed.size(), "changed");
  add(group.rounded(),
      fmt::format("different by rounding alone ({:.1e} at most, relative)", group.most_rounding));
  add(group.incomparable, "not comparable");
  return fmt::format("{} of {} on {}: {}", counted(group.cells.size(), "cell"),
                     few_names(group.optimizers, "optimizer"), few_names(group.problems, "problem"),
                     joined(parts));
}

std::vector<OtherTerms> take_other_terms(std::vector<const Subject*>& only_before,
                                         std::vector<const Subject*>& only_after) {
  std::map<std::string, const Subject*> by_title;
  for (const Subject* subject : only_after) by_title.emplace(subject->title, subject);
  std::map<std::string, OtherTerms> found;
  std::set<const Subject*> taken;
  for (const Subject* subject : only_before) {
    const auto at = by_title.find(subject->title);
    if (at == by_title.end()) continue;
    const std::string what = change_of_terms(*subject, *at->second);
    if (what.empty()) continue;
    OtherTerms& terms = found[what];
    ++terms.cells;
    terms.what = what;
    terms.optimizers.insert(subject->optimizer.name);
    taken.insert({subject, at->second});
    by_title.erase(at);
  }
  for (auto* side : {&only_before, &only_after})
    std::erase_if(*side, [&](const Subject* subject) { return taken.contains(subject); });
  std::vector<OtherTerms> all;
  for (auto& [what, terms] : found) all.push_back(std::move(terms));
  return all;
}

}  // namespace isoline::reports
