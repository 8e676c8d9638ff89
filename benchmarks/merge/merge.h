// Merges records and result folders. The result does not depend on their order or number.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/threads.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

// A file or an audit with different results in several folders.
struct Conflict {
  std::string optimizer;  // empty where it is not known
  std::string sentence;
  auto operator<=>(const Conflict&) const = default;
};

struct MergeOutcome {
  std::size_t records = 0;              // written
  std::size_t united = 0;               // of them, found in several folders with other timings
  std::vector<Conflict> conflicts;      // if there are any, merge does not write anything
  std::vector<std::string> unreadable;  // one sentence per damaged file, which merge omits
  bool is_interrupted = false;          // the user stopped merge: it does not write anything
};

// Writes `out` completely or not at all; a UsageError if it has results already. Copies a file that
// one folder has, or that is equal in all. Joins records with equal results, with the timings of
// all (unite_records), and plans, rates and audits; keeps the first component metadata. Anything
// else is a conflict. Names symbolic links in the folders and leaves them out. After Ctrl-C or
// SIGTERM, nothing of `out` remains.
MergeOutcome merge_folders(const std::vector<std::filesystem::path>& folders,
                           const std::filesystem::path& out, const Listener& listener = {});

// "adam: 12 conflicts" and the first sentence of each optimizer; the optimizer with the most
// conflicts comes first.
std::string conflicts_text(const std::vector<Conflict>& conflicts);

// Makes `record` the union with another record of its cell and build: the timings of both, each
// value as often as the record that has it most often, and the fields and spectrum that either
// keeps. Of the rest the later run's stays; a run that a clock or a kill ended gives way to one
// that ended by itself. Where two results differ it returns the first places, "/summary/loss (1,
// 2)", and changes nothing.
std::string unite_records(Json& record, const Json& other);

// The error in the file of fields of a record; empty if the file is valid.
std::string fields_violation(const Json& record, const std::filesystem::path& file);
// Likewise of its answer.
std::string answer_violation(const Json& record, const std::filesystem::path& file);

}  // namespace isoline::benchmarks
