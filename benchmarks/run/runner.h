// Runs requests in worker processes, several at once, and stores their records as they end. Cells
// of one problem run one after the other in a process that stays; some have one of their own.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/store.h"
#include "core/records/record.h"
#include "core/trace.h"

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
  std::vector<std::string> conflicts;       // cells whose repetition has another result
  std::vector<std::string> remarks;         // damaged files, missing metadata
  std::set<std::string> solved_at_start;    // problems
  std::vector<std::string> missing;  // cells that were done and whose records have disappeared
  std::int64_t reused_from_other_builds = 0;
  std::int64_t continued = 0;    // cells that began at the end of a run with a smaller budget
  std::int64_t interrupted = 0;  // cells that were killed from outside: the same run repeats them
  bool is_interrupted = false;   // stopped by the user
  double seconds = 0;            // that the run took

  void count(const Record& record);
  void uncount(const Record& record);
};

// Records may come from others. UsageError, with the command, before one that a record names
// starts.
void require_trust(bool is_given, const Record& record);
inline constexpr const char* kTrust = "Start the commands of external components in the records";

std::string title_of(const Request& request);  // "problem × optimizer, seed 0"

struct RunOptions {
  int jobs = 1;
  bool force = false;           // repeat cells that are done
  bool uncertified = false;     // run problems without their checks, and mark them
  bool reuse = false;           // a cell that another build has done counts as done
  std::set<Status> retry = {};  // cells that ended so are repeated
  bool exclusive = false;       // one at a time, for tables of wall time
  bool isolates_cells = false;  // each in a fresh process
  int repeat = 1;               // timings wanted of each cell
  Limits limits;
  int perturbation = 0;  // of the starts, in the last bit; of 0 alone the records are results
  Progress::Style progress = Progress::Style::silent;
  bool keeps_output = false;       // of cells, in their records
  bool logs_calls = false;         // of external problems, also where a call is fast
  bool keeps_fields = false;       // of every seed; else those of seed 0
  bool keeps_spectra = false;      // a record without them is computed again
  double least_kept_seconds = 60;  // of a cell whose state is kept for larger budgets
  std::string command;             // for the record

  bool redoes(const std::optional<Record>& done) const;  // whether that prevents nothing
};

// Runs the requests that the store has no record of, and no more. Several processes may run into
// one folder: each cell is done by one of them.
Outcome run_all(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                const RunOptions& options);

int one_a_core();  // how many cells at a time a machine is meant for

// Runs cells in this process, one after another, for a debugger, and calls back after each. No
// isolation, no limits but the soft budgets, no verification, no record: a crash ends this process.
void run_in_process(const Catalog& catalog, const std::vector<Request>& requests,
                    const std::function<void(const Request&, const Trace&)>& ended);

// The request of the record for the components of this program; UsageError if it no longer has
// them, or if they have other options. The cell is that of this program.
Request request_again(const Catalog& catalog, const Record& record, double hard_seconds);

// Recorded runs repeated from starts that differ in the last bit: values that then move depend on
// rounding, and so on the processor and the libraries, not on the method. Without cells that a
// clock or a kill ended, and inapplicable ones. UsageError where a record is of another build.
// Nothing where it was interrupted.
std::optional<std::vector<Record>> perturbed_records(const Catalog& catalog,
                                                     const std::vector<Record>& records, int number,
                                                     RunOptions options);

}  // namespace isoline::benchmarks
