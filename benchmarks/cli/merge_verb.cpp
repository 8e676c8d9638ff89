// isoline merge DIR... --out OUT: the union of result folders.
#include <fmt/format.h>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/merge/merge.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;

int merge_verb(const MergeArguments& given, Session&) {
  const std::vector<std::filesystem::path> folders(given.folders.begin(), given.folders.end());
  const MergeOutcome outcome = merge_folders(folders, given.out, on_terminal("files"));
  if (outcome.is_interrupted) {
    say(stderr, fmt::format("interrupted; nothing is left of {}\n", given.out));
    return kInterrupted;
  }
  for (const std::string& sentence : outcome.unreadable)
    say(stderr, fmt::format("left out: {}\n", sentence));
  if (!outcome.conflicts.empty()) {
    say(stderr, conflicts_text(outcome.conflicts));
    say(stderr, fmt::format("{} is not written: remove the wrong records, or --force their runs, and "
                            "merge again\n",
                            given.out));
    return kWorse;
  }
  say(stdout, fmt::format("{} in {}: {} with timings of several folders, {} left out\n",
                          counted(std::size_t(outcome.records), "record"), given.out,
                          outcome.united, outcome.unreadable.size()));
  return outcome.unreadable.empty() ? kGood : kWorse;
}

}  // namespace isoline::benchmarks
