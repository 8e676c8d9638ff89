// A preview of a plan: the cells that are cached, the cells that cannot exist and the reasons, and
// the predicted time of the others from earlier runs.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "core/records/request.h"
#include "core/results/study.h"
#include "core/status.h"
#include "core/threads.h"

namespace isoline::benchmarks {

// The values that a preview reads from a record; there may be hundreds of thousands of records.
struct RecordOutline {
  std::string cell;
  std::string problem, optimizer;  // specs
  Budget budget;
  int threads = 1;
  Status status = Status::running;
  // Processor time, which other programs hardly change; wall time if the cell has several threads
  // or waits for another program.
  double seconds = 0;
  std::string started;  // "2026-01-31T12:00:00Z"
};

// One per record of these result folders, which may be missing. Names the files that it cannot
// read.
std::vector<RecordOutline> record_outlines(const std::vector<std::filesystem::path>& folders,
                                           std::vector<results::Unreadable>& unreadable,
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
  std::map<std::string, std::vector<double>> seconds_;  // by cell and by question; sorted
};

struct PreviewedCell {
  const Request* request;
  bool is_cached = false;
  std::string why_inapplicable;  // empty: it can run
  std::optional<double> seconds =
      {};  // time of earlier runs of this cell, or of it with other seeds

  bool is_missing() const { return !is_cached && why_inapplicable.empty(); }
};

struct Preview {
  std::vector<PreviewedCell> cells;  // one per request, in order
  std::size_t likened = 0;  // settings of problems that were assumed to be like another one
  std::size_t timed = 0;    // cells with a prediction from earlier runs
};

// The counts of a plan, or of a part of it.
struct PreviewCounts {
  std::size_t cells = 0, cached = 0, inapplicable = 0, missing = 0;

  void add(const PreviewedCell& cell);
  // For the missing cells, one at a time; cells without a prediction count as the mean of the
  // others. Nothing if no earlier run predicts any.
  std::optional<double> seconds() const;

 private:
  std::size_t timed_ = 0;
  double timed_seconds_ = 0;
};
PreviewCounts counts_of(const std::vector<PreviewedCell>& cells);

// The records that count as done.
struct PreviewOptions {
  bool force = false;           // none
  bool reuse = false;           // also those of another build
  std::set<Status> retry = {};  // except those with these statuses
};

// Reads result folders without changing them. A cell is cached if one of them has it. If a sweep
// has more settings of problems than can be created in a second, the rest are assumed to be like
// the first.
Preview preview(const Catalog& catalog, const std::vector<Request>& requests,
                const std::vector<std::filesystem::path>& folders, const EarlierTimes& earlier = {},
                const PreviewOptions& options = {});

}  // namespace isoline::benchmarks
