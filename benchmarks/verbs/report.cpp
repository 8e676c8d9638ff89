// isoline report DIR...: tables, plots and statistics from records.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "core/errors.h"
#include "core/text.h"
#include "reports/read/metrics.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

namespace fs = std::filesystem;
namespace {

struct ReportArguments {
  std::vector<std::string> folders;
  std::string out, by = "work";
  double tolerance = 1e-6;
  bool opens = false;
};

void declare(VerbArguments& verb, ReportArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--out", given.out, "Where to write (default: report/ in the first DIR)");
  verb.text("--by", given.by, "What is counted, in orders, tables and plots")
      .one_of({reports::kMeasureNames.begin(), reports::kMeasureNames.end()})
      .shown();
  verb.real("--tolerance", given.tolerance, between(1e-10, 1),
            "Relative loss gap, or relative error in x, below which a problem counts as solved")
      .shown("1e-6");
  verb.flag("--open", given.opens, "Open the page in the browser of the desktop");
}

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

// By the desktop's own program, which goes on after this one; where there is none, that is told.
void open_page(const fs::path& page) {
  std::string program = "xdg-open", path = page.string();
  std::array<char*, 3> words = {program.data(), path.data(), nullptr};
  pid_t opened = 0;
  if (posix_spawnp(&opened, program.c_str(), nullptr, nullptr, words.data(), environ) != 0)
    say(stderr, fmt::format("--open: there is no xdg-open; open {} yourself\n", path));
}

// What it writes: "index.html, report.csv, …"
std::string format_names() {
  std::vector<std::string> names;
  for (const reports::Format& format : reports::kFormats) names.emplace_back(format.file);
  return reports::joined(names);
}

int run(const ReportArguments& given, Session& session) {
  const reports::Study study =
      reports::read_study(given.folders, progress_on_terminal("reading records"));
  require(!study.runs.empty(), [&] {
    const std::string damaged =
        study.unreadable.empty() ? ""
                                 : fmt::format(", and {} that cannot be read",
                                               reports::counted(study.unreadable.size(), "file"));
    return fmt::format("no records in {}{}: `isoline run --out FOLDER` writes them",
                       fmt::join(given.folders, ", "), damaged);
  });
  const reports::Yardstick yardstick = yardstick_of(given);
  const fs::path out =
      given.out.empty() ? given.folders.front() / fs::path("report") : fs::path(given.out);
  write_and_print(study, out, session, {.yardstick = yardstick});
  if (given.opens) open_page(out / "index.html");
  return kGood;
}

}  // namespace

void register_report(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "report",
       .help_position = 30,
       .summary = "Write " + format_names(),
       .examples = "  isoline report results/quick\n"
                   "  isoline report results/a results/b --out report --by cost --tolerance 1e-3",
       .notes =
           "Results know 51 tolerances, five a decade from 1 to 1e-10: one between two of them counts as the\n"
           "next stricter one. Work is oracle calls at declared prices, which any machine repeats; cost is\n"
           "the same calls at measured prices. Times are comparable in runs with --exclusive: others are\n"
           "marked ≈."},
      declare, run));
}

}  // namespace isoline::benchmarks
