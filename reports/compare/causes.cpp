// Gathers differences and missing cells by cause, optimizer and problem.
#include "reports/compare/causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "reports/sections/words.h"

namespace isoline::reports {

namespace {

bool is_of(const DifferenceGroup& group, const Difference& difference, bool by_problem) {
  return group.change == difference.change && group.cause == difference.cause &&
         group.optimizer == difference.optimizer &&
         (!by_problem || group.problems.contains(difference.problem));
}

void add(DifferenceGroup& group, const Difference& difference) {
  if (group.problems[difference.problem].insert(difference.key).second) ++group.cells;
  if (std::ranges::find(group.what, difference.what) == group.what.end())
    group.what.push_back(difference.what);
}

std::vector<DifferenceGroup> gathered(const std::vector<Difference>& differences, bool by_problem) {
  std::vector<DifferenceGroup> groups;
  for (const Difference& difference : differences) {
    if (difference.is_rounding) continue;
    const auto at = std::ranges::find_if(
        groups, [&](const DifferenceGroup& group) { return is_of(group, difference, by_problem); });
    if (at != groups.end()) {
      add(*at, difference);
      continue;
    }
    groups.push_back({.change = difference.change,
                      .cause = difference.cause,
                      .optimizer = difference.optimizer,
                      .problems = {},
                      .what = {},
                      .worst = difference});
    add(groups.back(), difference);
  }
  return groups;
}

}  // namespace

std::vector<DifferenceGroup> grouped(const std::vector<Difference>& differences,
                                     const std::map<std::string, std::size_t>& sizes) {
  std::vector<DifferenceGroup> groups = gathered(differences, false);
  for (DifferenceGroup& group : groups)
    if (const auto size = sizes.find(group.optimizer); size != sizes.end()) group.of = size->second;
  return groups;
}

std::vector<DifferenceGroup> grouped_by_problem(const std::vector<Difference>& differences) {
  return gathered(differences, true);
}

std::vector<LackGroup> grouped(const std::vector<const Subject*>& lacking,
                               const std::vector<Subject>& side) {
  std::map<std::string, LackGroup> groups;
  for (const Subject* subject : lacking) {
    LackGroup& group = groups[subject->optimizer.name];
    if (group.cells++ == 0) group.first = subject->title;
    group.problems.insert(subject->problem.name);
  }
  std::vector<LackGroup> list;
  for (const Subject& subject : side)
    if (const auto at = groups.find(subject.optimizer.name); at != groups.end()) ++at->second.of;
  for (auto& [optimizer, group] : groups) {
    group.optimizer = optimizer;
    list.push_back(std::move(group));
  }
  return list;
}

std::string share_text(std::size_t cells, std::size_t of) {
  return cells == of ? fmt::format("all {}", of) : fmt::format("{} of {}", cells, of);
}

// Gathers what differs by its cause; and what was asked with other budgets.

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

// Of the terms "seed 0, budget {"iterations":20,"target":1e-10}, threads 1": a flat object.
std::map<std::string, std::string> budget_in(const std::string& terms) {
  std::map<std::string, std::string> budget;
  const std::size_t begin = terms.find('{'), end = terms.rfind('}');
  if (begin == std::string::npos || end == std::string::npos) return budget;
  for (std::size_t at = begin + 1; at < end;) {
    const std::size_t stop = std::min(terms.find(',', at), end);
    const std::string member = terms.substr(at, stop - at);
    const std::size_t colon = std::min(member.find(':'), member.size());
    std::string key = member.substr(0, colon);
    std::erase(key, '"');
    budget[key] = member.substr(std::min(colon + 1, member.size()));
    at = stop + 1;
  }
  return budget;
}

std::string without_budget(const std::string& terms) {
  const std::size_t begin = terms.find('{'), end = terms.rfind('}');
  const bool has_budget = begin != std::string::npos && end != std::string::npos && end > begin;
  return has_budget ? terms.substr(0, begin) + terms.substr(end + 1) : terms;
}

std::string threads_in(const std::string& terms) {
  const std::size_t at = terms.rfind("threads ");
  return at == std::string::npos ? "" : terms.substr(at);
}

std::string value_text(const std::map<std::string, std::string>& budget, const std::string& key) {
  const auto at = budget.find(key);
  return at == budget.end() ? "no limit" : at->second;
}

std::string change_of_terms(const Subject& before, const Subject& after) {
  const auto old = budget_in(before.terms), now = budget_in(after.terms);
  std::set<std::string> keys;
  for (const auto* budget : {&old, &now})
    for (const auto& [key, value] : *budget) keys.insert(key);
  std::vector<std::string> changes;
  for (const std::string& key : keys)
    if (value_text(old, key) != value_text(now, key))
      changes.push_back(fmt::format("{} {} → {}", key, value_text(old, key), value_text(now, key)));
  if (without_budget(before.terms) != without_budget(after.terms))
    changes.push_back(fmt::format("{} → {}", threads_in(before.terms), threads_in(after.terms)));
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

std::string words_of(const CauseGroup& group) {
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

std::vector<OtherTerms> asked_otherwise(std::vector<const Subject*>& only_before,
                                        std::vector<const Subject*>& only_after) {
  std::map<std::string, const Subject*> by_title;
  for (const Subject* subject : only_after) by_title.emplace(subject->title, subject);
  std::map<std::string, OtherTerms> found;
  std::set<const Subject*> told;
  for (const Subject* subject : only_before) {
    const auto at = by_title.find(subject->title);
    if (at == by_title.end() || subject->terms.empty() || at->second->terms.empty()) continue;
    const std::string what = change_of_terms(*subject, *at->second);
    if (what.empty()) continue;
    OtherTerms& terms = found[what];
    if (terms.cells++ == 0) terms.first = subject->title;
    terms.what = what;
    terms.optimizers.insert(subject->optimizer.name);
    told.insert({subject, at->second});
    by_title.erase(at);
  }
  for (auto* side : {&only_before, &only_after})
    std::erase_if(*side, [&](const Subject* subject) { return told.contains(subject); });
  std::vector<OtherTerms> all;
  for (auto& [what, terms] : found) all.push_back(std::move(terms));
  return all;
}

}  // namespace isoline::reports
