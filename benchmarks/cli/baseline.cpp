// isoline baseline RESULTS: what later results are compared with, as one small file.
#include "reports/compare/baseline.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/perturbed_runs.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"

namespace isoline::benchmarks {

using reports::baseline_json;
using reports::read_study;
using reports::Study;
namespace {

struct BaselineArguments {
  std::vector<std::string> folders;
  std::string out;
  int perturbations = 2, jobs = 0;
};

// Studies of the same cells from perturbed starts, one a perturbation.
std::vector<Study> perturbed_studies(const BaselineArguments& given, Session& session,
                                     const Study& study) {
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const RunOptions options{.jobs = given.jobs > 0 ? given.jobs : cores,
                           .progress = Progress::style_of(STDERR_FILENO),
                           .command = session.command()};
  std::vector<Study> perturbed(static_cast<std::size_t>(given.perturbations));
  for (int i = 0; i < given.perturbations; ++i)
    perturbed[static_cast<std::size_t>(i)].runs =
        perturbed_records(session.catalog(), study.runs, i + 1, options);
  return perturbed;
}

void keep_baseline(const BaselineArguments& given, Session& session) {
  const Study study = read_study({given.folders.begin(), given.folders.end()});
  require(!study.runs.empty(), "there are no records to remember");
  const std::string text = baseline_json(study, perturbed_studies(given, session, study));
  if (given.out.empty()) {
    fmt::print("{}", text);
    return;
  }
  const std::filesystem::path folder = std::filesystem::path(given.out).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  write_text(given.out, text);
  fmt::print("{}: {} cells\n", given.out, study.runs.size());
}

}  // namespace

void add_baseline(CLI::App& app, Session& session) {
  const auto given = std::make_shared<BaselineArguments>();
  CLI::App* verb = app.add_subcommand(
      "baseline", "Keep what later results are compared with, as one small file");
  verb->add_option("RESULTS", given->folders, "Result folders of `isoline run`")->required();
  verb->add_option("--out", given->out, "The file (default: standard output)");
  verb->add_option("--perturbations", given->perturbations,
                   "Runs of each cell from a start perturbed in the last bit")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  verb->add_option("--jobs", given->jobs, "Cells at a time (default: one a core)")
      ->check(CLI::Range(1, 1024));
  verb->footer(
      "A line a cell: status, digest of the trace, final figures, work to 1e-1, 1e-3 and 1e-6.\n"
      "Each cell is run again from starts that differ in the last bit. Where its figures move by\n"
      "more than the tolerance of a comparison, that comparison judges it by its status and by\n"
      "which of 1e-1, 1e-3 and 1e-6 it reaches: rounding alone cannot make it worse.\n"
      "Made by the portable preset it means the same on every x86-64-v3 machine:\n"
      "  ISOLINE_PRESET=portable isoline run quick --out results/quick\n"
      "  ISOLINE_PRESET=portable isoline baseline results/quick --out baseline.json\n"
      "  isoline compare baseline.json results/quick");
  verb->callback([given, &session] { keep_baseline(*given, session); });
}

}  // namespace isoline::benchmarks
