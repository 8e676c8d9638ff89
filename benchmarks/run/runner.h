// Runs requests in worker processes, several at once, and stores a record of each as it ends.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/store.h"

namespace isoline::benchmarks {

struct RunOptions {
  int jobs = 1;
  bool force = false;           // repeat cells that are done
  bool reuse = false;           // a cell that another build has done counts as done
  std::set<Status> retry = {};  // cells that ended so are repeated
  bool exclusive = false;       // one at a time, for tables of wall time
  int repeat = 1;               // timings wanted of each cell
  Limits limits;
  double checkpoint_seconds = 120;  // how often a long run is kept on disk while it goes
  int perturbation = 0;  // of the starts, in the last bit; of 0 alone the records are results
  Progress::Style progress = Progress::Style::silent;
  std::string command;  // for the record
};

struct Outcome {
  std::int64_t planned = 0, reused = 0, run = 0;
  std::map<Status, std::int64_t> statuses;  // of all planned cells that have a record
  std::vector<std::string> failures;        // "problem × optimizer, seed 0: crashed: …"
  std::vector<std::string> conflicts;       // cells whose repetition gave another result
  std::int64_t reused_from_other_builds = 0;
  bool is_interrupted = false;
};

// Runs the requests that the store has no record of, and no more.
Outcome run_all(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                const RunOptions& options);

int one_a_core();  // how many cells at a time a machine is meant for

// The limits of one request: its soft time limit, doubled, is its hard one.
Limits limits_of(const Request& request, const Limits& standard);

}  // namespace isoline::benchmarks
