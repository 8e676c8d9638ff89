// How long a cell may take: what earlier runs of it, or of its like, took.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/records/request.h"
#include "core/status.h"
#include "core/threads.h"

namespace isoline::benchmarks {

// The few values that are read from records by the hundred thousand: the cell, its status, and its
// times.
struct RecordOutline {
  std::string cell;
  std::string problem, optimizer;  // specs
  Budget budget;
  int threads = 1;
  Status status = Status::running;
  double wall_seconds = 0;
  std::string started;  // "2026-01-31T12:00:00Z"
};

// One a record of these result folders. Files that cannot be read as records are passed over, and
// so are folders that are not there.
std::vector<RecordOutline> record_outlines(const std::vector<std::filesystem::path>& folders,
                                           const Listener& listener = {});

// The times of cells in earlier runs of any build.
class EarlierTimes {
 public:
  EarlierTimes() = default;
  explicit EarlierTimes(const std::vector<RecordOutline>& earlier);

  // The median over the records of this very cell; else over those of other seeds with the same
  // problem, optimizer, budget and threads. None where there is neither.
  std::optional<double> of(const Request& request) const;

 private:
  std::map<std::string, double> by_cell_, by_question_;
};

}  // namespace isoline::benchmarks
