// isoline report DIR...: tables, plots and statistics from records.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/reporting.h"
#include "benchmarks/cli/verbs.h"
#include "core/errors.h"

namespace isoline::benchmarks {

namespace fs = std::filesystem;
using reports::read_study;
using reports::Study;

int report_verb(const ReportArguments& given, Session& session) {
  const std::vector<fs::path> folders(given.folders.begin(), given.folders.end());
  const Study study = read_study(folders, on_terminal("reading records"));
  require(!study.runs.empty(), [&] {
    const std::string damaged =
        study.unreadable.empty()
            ? ""
            : fmt::format(", and {} files that cannot be read", study.unreadable.size());
    return fmt::format("no records in {}{}: `isoline run --out FOLDER` writes them",
                       fmt::join(given.folders, ", "), damaged);
  });
  write_and_print(study, given.out.empty() ? folders.front() / "report" : fs::path(given.out),
                  session);
  return kGood;
}

}  // namespace isoline::benchmarks
