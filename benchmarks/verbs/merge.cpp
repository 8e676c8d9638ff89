// isoline merge DIR... --out OUT: merges result folders.
#include "benchmarks/merge/merge.h"

#include <fmt/format.h>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

struct MergeArguments {
  std::vector<std::string> folders;
  std::string out;
};

void declare(VerbArguments& verb, MergeArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--out", given.out, "The new result folder").required();
}

int run(const MergeArguments& given, Session&) {
  const std::vector<std::filesystem::path> folders(given.folders.begin(), given.folders.end());
  const MergeOutcome outcome = merge_folders(folders, given.out, progress_on_terminal("files"));
  if (outcome.is_interrupted) {
    say(stderr, fmt::format("interrupted; {} was not written\n", given.out));
    return kInterrupted;
  }
  for (const std::string& sentence : outcome.unreadable)
    say(stderr, fmt::format("left out: {}\n", sentence));
  if (!outcome.conflicts.empty()) {
    say(stderr, conflicts_text(outcome.conflicts));
    say(stderr,
        fmt::format(
            "{} was not written: remove the wrong records, or run their cells again with --force, "
            "and merge again\n",
            given.out));
    return kWorse;
  }
  say(stdout, fmt::format("{} in {}: {} with timings of several folders, {} left out\n",
                          reports::counted(std::size_t(outcome.records), "record"), given.out,
                          outcome.united, outcome.unreadable.size()));
  return outcome.unreadable.empty() ? kGood : kWorse;
}

}  // namespace

void register_merge(VerbRegistry& registry) {
  registry.add(verb_of<MergeArguments>(
      {.name = "merge",
       .help_position = 26,
       .summary = "Merge result folders into a new one",
       .examples = "  isoline merge results/a results/b --out results/both",
       .notes =
           "Records of the same cell (one problem, one optimizer, one seed) and build become one "
           "record with the times of all of them. If they differ in anything except times and "
           "provenance, `merge` does not write anything, lists the cells on standard error, and "
           "exits with code 2. Remove the "
           "wrong records, or run their cells again with --force, and merge again."},
      declare, run));
}

}  // namespace isoline::benchmarks
