// The runs of a plan that are still wanted, each given to one run of the folder alone.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/run/runner.h"
#include "benchmarks/run/store.h"

namespace isoline::benchmarks {

// Locks on one file of the folder, one byte per cell. The system releases them when their process
// ends, in whatever way; processes started by it do not share them. On a file system without locks
// each run does all cells: some work is done twice, and nothing is lost. One object per folder and
// process: closing the file drops all of its locks.
class Holds {
 public:
  explicit Holds(const std::filesystem::path& folder);
  ~Holds();
  Holds(const Holds&) = delete;
  Holds& operator=(const Holds&) = delete;

  bool take(const std::string& cell);  // false while another process has it
  void release(const std::string& cell);

 private:
  int descriptor_;
};

// How many cells of a result folder runs in other processes hold at the moment, according to the
// file system; 0 if the folder has none.
std::size_t held_cells(const std::filesystem::path& folder);

// The runs of a plan that are still wanted, each given to one run of the folder alone.

class Pending {
 public:
  // Counts the cells that are done already.
  Pending(const std::vector<Request>& requests, Store& store, const RunOptions& options,
          Outcome& outcome);

  // The next run, held against other processes until it is released. None where all are given out,
  // or where others are doing all that are left: these are done elsewhere, or come back.
  const Request* next();
  void release(const Request& request);
  bool is_empty() const { return queue_.empty(); }
  std::size_t size() const { return queue_.size(); }
  const std::deque<const Request*>& queued() const { return queue_; }

 private:
  std::size_t runs_wanted(const Request& request);
  bool is_reused(const Request& request, const RecordsOfAnyBuild& earlier);
  void count_reused(const Record& done);

  Store& store_;
  const RunOptions& options_;
  Outcome& outcome_;
  Holds holds_;
  std::deque<const Request*> queue_;  // a cell that needs several timings is queued as often
  std::int64_t look_again_ = 0;       // monotonic nanoseconds
};

}  // namespace isoline::benchmarks
