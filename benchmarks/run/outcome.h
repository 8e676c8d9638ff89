// What a run of a plan came to.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/records/record.h"

namespace isoline::benchmarks {

struct Crash {
  Request request;
  std::string record;  // below the result folder
};

struct Outcome {
  std::int64_t planned = 0, reused = 0, run = 0;
  std::map<Status, std::int64_t> statuses;  // of all planned cells that have a record
  std::vector<std::string> failures;        // "problem × optimizer, seed 0: crashed: …"
  std::optional<Crash> crash;               // the first of them
  std::vector<std::string> conflicts;       // cells whose repetition gave another result
  std::vector<std::string> remarks;         // damaged files, sheets that could not be made
  std::vector<std::string> missing;         // cells that were done and whose record is gone
  std::int64_t reused_from_other_builds = 0;
  std::int64_t interrupted = 0;  // cells that somebody killed: the same run runs them again
  bool is_interrupted = false;   // asked to end
  double seconds = 0;            // that the run took

  void count(const Record& record);
};

std::string title_of(const Request& request);  // "problem × optimizer, seed 0"

}  // namespace isoline::benchmarks
