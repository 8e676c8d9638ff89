// Unites result folders: what comes out does not depend on their order or on how often one is
// given.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/threads.h"

namespace isoline::benchmarks {

// A file or an audit with different results in several folders.
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
  bool is_interrupted = false;          // on request of the user: nothing is written
};

// Writes `out` completely or not at all; a UsageError if it has results already. Copies a file that
// one folder has, or that is equal in all. Joins records with equal results, with the timings of
// all (record_union.h), and plans, rates and audits; keeps the first component metadata. Anything
// else is a conflict. Names symbolic links in the folders and leaves them out. After Ctrl-C or
// SIGTERM, nothing of `out` remains.
MergeOutcome merge_folders(const std::vector<std::filesystem::path>& folders,
                           const std::filesystem::path& out, const Listener& listener = {});

// "adam: 12 conflicts" and the first of its sentences, the optimizer with most conflicts first.
std::string conflicts_text(const std::vector<Conflict>& conflicts);

}  // namespace isoline::benchmarks
