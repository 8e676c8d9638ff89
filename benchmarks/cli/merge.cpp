// isoline merge DIR... --out OUT: the union of result folders.
#include "benchmarks/merge/merge.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "benchmarks/cli/verbs.h"

namespace isoline::benchmarks {
namespace {

struct MergeArguments {
  std::vector<std::string> folders;
  std::string out;
};

void merge(const MergeArguments& given, Session& session) {
  const std::vector<std::filesystem::path> folders(given.folders.begin(), given.folders.end());
  const MergeOutcome outcome = merge_folders(folders, given.out, on_terminal("files"));
  for (const std::string& sentence : outcome.conflicts)
    fmt::print(stderr, "conflict: {}\n", sentence);
  for (const std::string& sentence : outcome.unreadable)
    fmt::print(stderr, "unreadable: {}\n", sentence);
  for (const std::string& sentence : outcome.remarks) fmt::print("{}\n", sentence);
  fmt::print("{} records in {}: {} with timings of several folders, {} left out\n", outcome.records,
             given.out, outcome.united, outcome.conflicts.size() + outcome.unreadable.size());
  if (!outcome.conflicts.empty() || !outcome.unreadable.empty()) session.exit_code = kWorse;
}

}  // namespace

void add_merge(CLI::App& app, Session& session) {
  const auto given = std::make_shared<MergeArguments>();
  CLI::App* verb = app.add_subcommand("merge", "Unite result folders into a new one");
  verb->add_option("DIR", given->folders, "Result folders of `isoline run`")->required();
  verb->add_option("--out", given->out, "The new result folder")->required();
  verb->footer(
      "Records of the same cell and build become one with the timings of all. Where they differ "
      "in\n"
      "anything but timings and provenance the record is left out, the cell is named on standard\n"
      "error, OUT/conflicts.json remembers it, and the exit code is 2; all else is written. To\n"
      "resolve a conflict remove the wrong record, or --force its run, and merge again.");
  verb->callback([given, &session] { merge(*given, session); });
}

}  // namespace isoline::benchmarks
