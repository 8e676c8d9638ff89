// Gathers differences and missing cells by cause, optimizer and problem.
#include "reports/compare/groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

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

}  // namespace isoline::reports
