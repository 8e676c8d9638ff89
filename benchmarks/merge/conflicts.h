// What folders disagree on: remembered in `conflicts.json`, and told by optimizer.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace isoline::benchmarks {

inline constexpr const char* kConflictsSchema = "isoline.conflicts/1";

// What an earlier merge left out: names of records, and of optimizers whose audits differ.
struct Disputed {
  std::set<std::string> records, audits;
};

// Nothing where the folder has no conflicts.json; UsageError, which names it, where that is none:
// without it a merge would choose by accident.
Disputed disputed_in(const std::filesystem::path& folder);

// A file of which folders hold different results.
struct Conflict {
  std::string optimizer;  // empty where it is not known
  std::string sentence;
  auto operator<=>(const Conflict&) const = default;
};

// "adam: the results of 12 cells differ", and the first of its sentences: an optimizer a paragraph,
// the one with most conflicts first.
std::string told(const std::vector<Conflict>& conflicts);

}  // namespace isoline::benchmarks
