// Unites result folders: what comes out does not depend on their order or on how often one is
// given.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/threads.h"

namespace isoline::benchmarks {

// A file, or an audit, of which folders hold different results.
struct Conflict {
  std::string optimizer;  // empty where it is not known
  std::string sentence;
  auto operator<=>(const Conflict&) const = default;
};

struct MergeOutcome {
  std::size_t records = 0;              // written
  std::size_t united = 0;               // of them, found in several folders with other timings
  std::vector<Conflict> conflicts;      // where there are any, nothing is written
  std::vector<std::string> unreadable;  // a sentence a damaged file; it is left out
  bool is_interrupted = false;          // asked to end: nothing is written
};

// Writes `out` whole or not at all; a UsageError where it holds results already. A file that one
// folder has, or all have alike, is copied; records of equal results become one with the timings of
// all (record_union.h); plans, rates and audits are united; of sheets the first stays. Anything
// else is a conflict. Symbolic links in the folders are named and left out. Ctrl-C or a polite kill
// leaves no trace of `out`.
MergeOutcome merge_folders(const std::vector<std::filesystem::path>& folders,
                           const std::filesystem::path& out, const Listener& listener = {});

// "adam: 12 conflicts" and the first of its sentences, the optimizer with most conflicts first.
std::string conflicts_text(const std::vector<Conflict>& conflicts);

}  // namespace isoline::benchmarks
