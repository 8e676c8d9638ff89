// The run that a command line requests: its cells, its name, the folder of its records, and its
// division into shards; and what --dry-run prints about it.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/rates.h"
#include "core/errors.h"

namespace isoline::benchmarks {

struct RunArguments {
  std::string suite, problem, optimizer, instead, view, seeds, instances, starts, out, best,
      rates = "builtin";
  std::string start, target_data;                           // files
  std::int64_t stall = -1;                                  // −1: as the suite has it; 0: never
  std::string stop;                                         // empty: as the suite has it
  std::string shard;                                        // "3/16", "auto"; empty: the whole
  std::string isolate;                                      // "cell"; empty: by problem
  std::int64_t iterations = 0, work = 0, memory_bytes = 0;  // 0: as the suite or the runner has it
  double seconds = 0, target = -1;                          // 0, −1: as the suite has it
  std::vector<std::string> retry;                           // statuses
  std::vector<std::string> earlier;                         // result folders, with --dry-run
  int shards = 0;                                           // 0: the whole
  int jobs = 0, threads = 0, repeat = 1;                    // 0: one a core; as the suite has it
  bool force = false, reuse = false, is_dry = false, as_json = false, lists_all = false,
       exclusive = false;
  bool no_report = false, quiet = false, allow_large = false, keeps_output = false;
  bool logs_evaluations = false;
  bool keeps_fields = false;
  bool keeps_spectra = false, keeps_states = false;
  bool in_process = false, uncertified = false;
};
void declare_run(VerbArguments& verb, RunArguments& given);

// Calls read(); its UsageError begins with the flag or the file that it is about.
auto read_as(const std::string& origin, const auto& read) {
  try {
    return read();
  } catch (const UsageError& error) {
    throw UsageError(origin + ": " + error.what());
  }
}

struct PlannedRun {
  std::string name;
  std::vector<Request> requests;
  std::filesystem::path folder;
  Rates rates = {};
};

// A suite, whole or the part of it that --problem and --optimizer keep; or a matrix of these alone.
// Only a whole suite goes to the folder of its name: a part there would pass for the whole.
PlannedRun planned_run(const RunArguments& given, const Catalog& catalog);

// Leaves one shard, in a folder of its own. The plan that is stored there stays whole: a part never
// passes for it.
void keep_shard(const std::string& shard, PlannedRun& all);

// --retry as statuses. What was interrupted is run again without it.
std::set<Status> statuses_of(const std::vector<std::string>& names);

// Prints what a run would do, its predicted time and its division into shards; or, for a result
// folder in place of a suite, the progress of its run. Runs nothing. The exit code.
int dry_run(const RunArguments& given, Session& session);

}  // namespace isoline::benchmarks
