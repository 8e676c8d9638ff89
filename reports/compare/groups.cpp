// Gathers differences and missing cells by optimizer.
#include "reports/compare/groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace isoline::reports {

std::vector<DifferenceGroup> grouped(const std::vector<Difference>& differences,
                                     const std::map<std::string, std::size_t>& sizes) {
  std::vector<DifferenceGroup> groups;
  std::vector<std::set<std::string>> cells;
  for (const Difference& difference : differences) {
    const auto is_its = [&](const DifferenceGroup& group) {
      return group.optimizer == difference.optimizer && group.change == difference.change;
    };
    const auto at = std::ranges::find_if(groups, is_its);
    const auto index = static_cast<std::size_t>(at - groups.begin());
    if (at == groups.end()) {
      const auto size = sizes.find(difference.optimizer);
      groups.push_back({.change = difference.change,
                        .optimizer = difference.optimizer,
                        .cells = 0,
                        .of = size == sizes.end() ? 0 : size->second,
                        .what = {},
                        .worst = difference});
      cells.emplace_back();
    }
    DifferenceGroup& group = groups[index];
    cells[index].insert(difference.key);
    group.cells = cells[index].size();
    if (std::ranges::find(group.what, difference.what) == group.what.end())
      group.what.push_back(difference.what);
  }
  return groups;
}

std::vector<LackGroup> grouped(const std::vector<const Subject*>& lacking,
                               const std::vector<Subject>& side) {
  std::map<std::string, LackGroup> groups;
  for (const Subject* subject : lacking) {
    LackGroup& group = groups[subject->optimizer.name];
    if (group.cells++ == 0) group.first = subject->title;
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
