// isoline report DIR...: writes tables, plots and statistics of records.
#include "reports/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/cli/views.h"
#include "benchmarks/plan/claim_cells.h"
#include "core/errors.h"
#include "core/records/naming.h"
#include "core/results/study.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

namespace fs = std::filesystem;
namespace {

struct ReportArguments {
  std::vector<std::string> folders;
  std::string out, problem, by = "work";
  double tolerance = 1e-6;
  bool opens = false;
  View view;
};

void declare(VerbArguments& verb, ReportArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--out", given.out, "Output folder (default: report/ in the first DIR)");
  verb.text("--problem", given.problem,
            "Problems of the report, by name and options (default: all)");
  verb.text("--by", given.by, "Metric of rankings, tables and plots")
      .one_of({reports::kMeasureNames.begin(), reports::kMeasureNames.end()})
      .shown();
  verb.real("--tolerance", given.tolerance, between(1e-10, 1),
            "Relative loss or error in x at which a problem counts as solved")
      .shown("1e-6");
  verb.flag("--open", given.opens, "Open the page in the desktop browser");
  declare_choice(verb, declare_view(verb, given.view.name), given.view);
}

// The requested tolerance, or the next stricter one of the 51.
reports::Yardstick yardstick_of(const ReportArguments& given) {
  const reports::Yardstick yardstick =
      reports::yardstick_at(*reports::measure_of(given.by), given.tolerance);
  const reports::Tolerance& taken = yardstick.tightest();
  constexpr double kRounding = 1e-9;
  if (taken.tau < given.tolerance * (1 - kRounding))
    say(stderr, fmt::format("--tolerance {}: rounded to {}, the next stricter one of the 51\n",
                            given.tolerance, taken.name));
  return yardstick;
}

// Leaves out the runs and the planned cells of other problems. A spec keeps each setting that has
// its name and all its options.
void keep_problems(reports::Study& study, const std::string& text) {
  std::set<std::string> kept;  // specifications, as cells have them
  for (const Record& run : study.runs)
    if (is_named(run.request.problem, text)) kept.insert(run.request.problem.spec);
  std::erase_if(study.runs,
                [&](const Record& run) { return !kept.contains(run.request.problem.spec); });
  std::erase_if(study.plan.cells,
                [&](const PlannedCell& cell) { return !kept.contains(cell.problem); });
  require(!study.runs.empty(), [&] {
    return fmt::format("--problem {}: these results do not contain this problem", text);
  });
}

// By the desktop's program, which outlives this one; prints a message if it is missing.
void open_page(const fs::path& page) {
  std::string program = "xdg-open", path = page.string();
  std::array<char*, 3> words = {program.data(), path.data(), nullptr};
  pid_t opened = 0;
  if (posix_spawnp(&opened, program.c_str(), nullptr, nullptr, words.data(), environ) != 0)
    say(stderr,
        fmt::format("--open needs xdg-open, which is not installed; open {} yourself\n", path));
}

// The files that it writes: "index.html, report.csv, …"
std::string format_names() {
  std::vector<std::string> names;
  for (const reports::Format& format : reports::kFormats) names.emplace_back(format.file);
  return reports::joined(names);
}

int show(const ReportArguments& given) {
  View view = given.view;
  view.tolerance = given.tolerance;
  reports::Study study = study_of(given.folders);
  require(!study.runs.empty(), "no records; `isoline run --out FOLDER` creates some");
  if (!given.problem.empty()) keep_problems(study, given.problem);
  print_view(study, view);
  return kGood;
}

int run(const ReportArguments& given, Session& session) {
  if (!given.view.name.empty()) return show(given);
  reports::Study study = study_of_report(given.folders, session);
  if (!given.problem.empty()) keep_problems(study, given.problem);
  const reports::Yardstick yardstick = yardstick_of(given);
  const fs::path out =
      given.out.empty() ? given.folders.front() / fs::path("report") : fs::path(given.out);
  write_and_print(study, out, session, {.yardstick = yardstick});
  if (given.opens) open_page(out / "index.html");
  return kGood;
}

}  // namespace

void register_report(VerbRegistry& registry) {
  registry.add(verb_of<ReportArguments>(
      {.name = "report",
       .help_position = 30,
       .summary = "Write " + format_names(),
       .examples = "  isoline report results/quick\n"
                   "  isoline report results/quick --problem heat --out heat\n"
                   "  isoline report results/a results/b --out report --by cost --tolerance 1e-3\n"
                   "  isoline report results/quick --view choice --have forward --unknowns 50",
       .notes =
           "Results contain 51 tolerances, five per decade from 1 to 1e-10; another tolerance is "
           "replaced by the next stricter one. Work counts oracle calls at nominal cost, which is "
           "equal "
           "on every machine; cost counts the same calls at measured cost. Times are comparable "
           "only in "
           "runs with --exclusive; others are marked ≈.\n"
           "--view writes no files. In the view choice, methods marked * are not significantly "
           "worse than the first one; its first sentence is also in the tab 'Choose a method' of "
           "the page."},
      declare, run));
}

}  // namespace isoline::benchmarks
