// The runs of a plan that are still wanted, each given to one run of the folder alone.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "benchmarks/run/hold.h"
#include "benchmarks/run/outcome.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/store.h"

namespace isoline::benchmarks {

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
  std::deque<const Request*> queue_;  // a cell that is to be timed anew stands in it as often
  std::int64_t look_again_ = 0;       // monotonic nanoseconds
};

}  // namespace isoline::benchmarks
