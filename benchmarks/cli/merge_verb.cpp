// isoline merge DIR... --out OUT: the union of result folders.
#include <fmt/format.h>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/merge/merge.h"

namespace isoline::benchmarks {

int merge_verb(const MergeArguments& given, Session&) {
  const std::vector<std::filesystem::path> folders(given.folders.begin(), given.folders.end());
  const MergeOutcome outcome = merge_folders(folders, given.out, on_terminal("files"));
  for (const std::string& sentence : outcome.conflicts)
    fmt::print(stderr, "conflict: {}\n", sentence);
  for (const std::string& sentence : outcome.unreadable)
    fmt::print(stderr, "unreadable: {}\n", sentence);
  for (const std::string& sentence : outcome.remarks) fmt::print("{}\n", sentence);
  fmt::print("{} records in {}: {} with timings of several folders, {} left out\n", outcome.records,
             given.out, outcome.united, outcome.conflicts.size() + outcome.unreadable.size());
  return outcome.conflicts.empty() && outcome.unreadable.empty() ? kGood : kWorse;
}

}  // namespace isoline::benchmarks
