// isoline baseline RESULTS: writes one small file with which later results are compared.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "benchmarks/cli/verb.h"
#include "benchmarks/run/runner.h"
#include "core/errors.h"
#include "core/output.h"
#include "core/results/study.h"
#include "core/text.h"
#include "reports/compare/gate.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

struct BaselineArguments {
  std::vector<std::string> folders;
  std::string out;
  int perturbations = 2, jobs = 0;
  bool trust = false;
};

void declare(VerbArguments& verb, BaselineArguments& given) {
  verb.texts("RESULTS", given.folders, "Result folders of `isoline run`").required();
  verb.text("--out", given.out, "The baseline file (default: standard output)");
  verb.whole(
      "--perturbations", given.perturbations,
      "Number of further runs of each cell, from starting points that differ in the last bit",
      {0, 100});
  verb.whole("--jobs", given.jobs, "Number of cells at a time (default: one per core)", kJobs);
  verb.flag("--trust", given.trust, kTrust);
  verb.plugins();
}

// Studies of the same cells from perturbed starts, one a perturbation; fewer where interrupted.
std::vector<reports::Study> perturbed_studies(const BaselineArguments& given, Session& session,
                                              const reports::Study& study) {
  const RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                           .progress = Progress::style_of(STDERR_FILENO),
                           .command = session.command()};
  std::vector<reports::Study> perturbed;
  for (int number = 1; number <= given.perturbations; ++number) {
    auto records = perturbed_records(session.catalog(), study.runs, number, options);
    if (!records) break;
    perturbed.emplace_back().runs = std::move(*records);
  }
  return perturbed;
}

int run(const BaselineArguments& given, Session& session) {
  reports::Study study = reports::read_study({given.folders.begin(), given.folders.end()});
  std::erase_if(study.runs, [](const Record& run) { return run.imported.has_value(); });
  require(!study.runs.empty(),
          "no records in these folders; `isoline run --out FOLDER` creates some");
  if (!given.out.empty()) {
    make_output_folder(std::filesystem::path(given.out).parent_path());
    require_ours(given.out, reports::kBaselineSchema);
  }
  if (given.perturbations > 0)
    for (const Record& run : study.runs) require_trust(given.trust, run);
  const std::vector<reports::Study> perturbed = perturbed_studies(given, session, study);
  if (perturbed.size() < static_cast<std::size_t>(given.perturbations)) {
    say(stderr, "interrupted; no baseline was written\n");
    return kInterrupted;
  }
  const std::string text = reports::baseline_json(study, perturbed);
  if (given.out.empty()) {
    say(stdout, text);
    return kGood;
  }
  write_output(given.out, text, reports::kBaselineSchema);
  say(stdout, fmt::format("{}: {}\n", given.out, reports::counted(study.runs.size(), "cell")));
  return kGood;
}

}  // namespace

void register_baseline(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "baseline",
       .help_position = 50,
       .summary = "Write a small file that later results are compared with",
       .examples = "  isoline baseline results/quick --out baseline.json\n"
                   "  isoline compare baseline.json results/quick",
       .notes =
           "The file has one line per cell (one problem, one optimizer, one seed): its status, a "
           "digest of its curve, its final values, and the work needed to reach 1e-1, 1e-3 and "
           "1e-6.\n"
           "Each cell runs again from starting points that differ in the last bit. A cell is "
           "chaotic if its values then change by more than a tenth of the tolerance of `compare`. "
           "`compare` judges such cells by their status and by the tolerances 1e-1, 1e-3 and 1e-6 "
           "that they reach, so rounding alone is not a regression.\n"
           "Runs of the portable preset (ISOLINE_PRESET=portable) give the same baseline on "
           "every x86-64-v3 machine."},
      declare, run));
}

}  // namespace isoline::benchmarks
