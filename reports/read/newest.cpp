// Chooses among the records of each cell.
#include "reports/read/newest.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>
#include <unordered_map>

namespace isoline::reports {
namespace {

// ISO times sort as text; the file name decides where they are absent or equal.
bool is_newer(const RunMark& a, const RunMark& b) {
  return std::pair(a.started, record_file_name(a.cell, a.build)) >
         std::pair(b.started, record_file_name(b.cell, b.build));
}

// What no clock decides is the same in all records of one build.
bool should_agree(const RunMark& a, const RunMark& b) {
  return a.build == b.build && !a.is_nondeterministic && !b.is_nondeterministic;
}

}  // namespace

RunMark mark_of(const Record& record) {
  return {.cell = record.cell,
          .build = record.build,
          .started = record.provenance.run.started,
          .problem = record.request.problem.spec,
          .optimizer = record.request.optimizer.spec,
          .seed = record.request.seed,
          .is_nondeterministic = record.is_nondeterministic};
}

Newest newest_of(const std::vector<RunMark>& marks,
                 const std::function<bool(std::size_t, std::size_t)>& are_at_odds) {
  Newest newest;
  std::unordered_map<std::string_view, std::size_t> known;  // by cell, its newest so far
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i].cell.empty()) continue;
    const auto [at, is_first] = known.emplace(marks[i].cell, i);
    if (is_first) continue;
    ++newest.superseded;
    if (should_agree(marks[i], marks[at->second]) && are_at_odds(i, at->second))
      newest.disputed.insert(marks[i].cell);
    if (is_newer(marks[i], marks[at->second])) at->second = i;
  }
  for (const auto& [cell, i] : known) newest.kept.push_back(i);
  std::ranges::sort(newest.kept, {}, [&](std::size_t i) {
    return std::tie(marks[i].problem, marks[i].optimizer, marks[i].seed, marks[i].cell);
  });
  return newest;
}

bool are_at_odds(const Record& a, const Record& b) {
  return result_of(to_json(a)) != result_of(to_json(b));
}

}  // namespace isoline::reports
