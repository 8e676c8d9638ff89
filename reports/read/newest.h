// Of all records of a cell the newest counts, whichever build wrote it.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "core/records/record.h"

namespace isoline::reports {

// What decides between records of a cell, and what orders those of several.
struct RunMark {
  std::string cell, build, started, problem, optimizer;  // its digests; when; its specs
  std::uint64_t seed = 0;
  bool is_nondeterministic = false;
};
RunMark mark_of(const Record& record);

struct Newest {
  std::vector<std::size_t> kept;   // one a cell, by problem, optimizer and seed
  std::size_t superseded = 0;      // left aside for a newer one
  std::set<std::string> disputed;  // cells of which two records of one build hold other results
};

// A mark without a cell stands for no record. Whether two of one build hold other results is asked
// only where both should hold the same.
Newest newest_of(const std::vector<RunMark>& marks,
                 const std::function<bool(std::size_t, std::size_t)>& are_at_odds);

// Whether they hold other results, times aside.
bool are_at_odds(const Record& a, const Record& b);

}  // namespace isoline::reports
