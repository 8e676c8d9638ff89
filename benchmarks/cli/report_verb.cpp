// isoline report DIR...: tables, plots and statistics from records.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/reporting.h"
#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/text.h"
#include "reports/read/yardstick.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;

namespace fs = std::filesystem;
using reports::read_study;
using reports::Study;
namespace {

// The tolerance asked for, or the next stricter one that results know.
reports::Yardstick yardstick_of(const ReportArguments& given) {
  const reports::Yardstick yardstick =
      reports::yardstick_at(*reports::measure_of(given.by), given.tolerance);
  const reports::Tolerance& taken = yardstick.tightest();
  constexpr double kRounding = 1e-9;
  if (taken.tau < given.tolerance * (1 - kRounding))
    say(stderr, fmt::format("--tolerance {}: taken as {}, the next stricter one of the 51\n",
                            given.tolerance, taken.name));
  return yardstick;
}

}  // namespace

int report_verb(const ReportArguments& given, Session& session) {
  const Study study = read_study(given.folders, on_terminal("reading records"));
  require(!study.runs.empty(), [&] {
    const std::string damaged =
        study.unreadable.empty()
            ? ""
            : fmt::format(", and {} that cannot be read", counted(study.unreadable.size(), "file"));
    return fmt::format("no records in {}{}: `isoline run --out FOLDER` writes them",
                       fmt::join(given.folders, ", "), damaged);
  });
  const reports::Yardstick yardstick = yardstick_of(given);
  write_and_print(
      study, given.out.empty() ? fs::path(given.folders.front()) / "report" : fs::path(given.out),
      session, false, yardstick);
  return kGood;
}

}  // namespace isoline::benchmarks
