// Unites result folders. What comes out depends on the set of records alone: not on the order of
// the folders, on their grouping, or on how often one is given.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/merge/conflicts.h"
#include "core/threads.h"

namespace isoline::benchmarks {

struct MergeOutcome {
  std::size_t records = 0;              // written
  std::size_t united = 0;               // of them, found in several folders with other timings
  std::vector<Conflict> conflicts;      // a file whose copies differ: it is left out
  std::vector<std::string> unreadable;  // a sentence a file that is no JSON; it is left out
  std::vector<std::string> remarks;     // what else a reader should know
  bool is_interrupted = false;          // asked to end: nothing is written
};

// Writes `out` whole or not at all; a UsageError where it holds results already.
//
// Records join on cell and build: their lists of timings are united, every value as often as the
// folder that has it most often. Of differing timings elsewhere and differing provenance the latest
// run's stay; a record that a clock or a kill ended gives way to one that ended by itself. Any
// other difference is a conflict: that record is left out, and `conflicts.json` remembers it, so
// that a later merge does not choose by accident. So it is with what was audited of an optimizer.
//
// Only what stands in the folders themselves is read: symbolic links in them are named and left
// out. Ctrl-C or a polite kill leaves no trace of `out`.
MergeOutcome merge_folders(const std::vector<std::filesystem::path>& folders,
                           const std::filesystem::path& out, const Listener& listener = {});

}  // namespace isoline::benchmarks
