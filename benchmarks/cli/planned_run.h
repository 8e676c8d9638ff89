// The run that a command line requests: its cells, its name, the folder of its records, and its
// division into shards. `run` and `plan` parse it in the same way.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/rates.h"
#include "benchmarks/run/preview.h"
#include "benchmarks/shard/split.h"

namespace isoline::benchmarks {

struct RunArguments {
  std::string suite, problem, optimizer, seeds, instances, starts, out, best, rates = "builtin";
  std::string start, target_data;                           // files
  std::int64_t stall = -1;                                  // −1: as the suite has it; 0: never
  std::string stop;                                         // empty: as the suite has it
  std::string shard;                                        // "3/16", "auto"; empty: the whole
  std::int64_t iterations = 0, work = 0, memory_bytes = 0;  // 0: as the suite or the runner has it
  double seconds = 0, target = -1;                          // 0, −1: as the suite has it
  std::vector<std::string> retry;                           // statuses
  int jobs = 0, threads = 0, repeat = 1;                    // 0: one a core; as the suite has it
  bool force = false, reuse = false, is_dry = false, lists_all = false, exclusive = false;
  bool no_report = false, quiet = false, allow_large = false, keeps_output = false;
  bool logs_evaluations = false;
  bool keeps_fields = false;
  bool keeps_spectra = false, keeps_states = false;
  bool in_process = false, uncertified = false;
};
void declare_run(VerbArguments& verb, RunArguments& given);
// The arguments of `run` that `plan` has too.
void declare_cells(VerbArguments& verb, RunArguments& given);
void declare_what_is_done(VerbArguments& verb, RunArguments& given);

struct PlannedRun {
  std::string name;
  std::vector<Request> requests;
  std::filesystem::path folder;
  Rates rates = {};
};

// A suite, whole or the part of it that --problem and --optimizer keep; or a matrix of these alone.
// Only a whole suite goes to the folder of its name: a part there would pass for the whole.
PlannedRun planned_run(const RunArguments& given, const Catalog& catalog);

// --retry as statuses. What was interrupted is run again without it.
std::set<Status> statuses_of(const std::vector<std::string>& names);

// "36 cells: 4 cached, 2 inapplicable, 30 to run, about 12 s with 2 at a time"
std::string preview_text(const PreviewCounts& counts, int jobs);

// That text, and how many settings were predicted from others of the same problem.
void print_counts(const Preview& shown, int jobs);

// The preview of a run, from the records in its folder and in other result folders.
Preview preview_of(const PlannedRun& all, const RunArguments& given,
                   const std::vector<std::string>& earlier,
                   const std::vector<std::filesystem::path>& folders, Session& session);

}  // namespace isoline::benchmarks
