// isoline baseline RESULTS: what later results are compared with, as one small file.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/perturbed_runs.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"
#include "reports/compare/baseline.h"
#include "reports/read/study.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::baseline_json;
using reports::counted;
using reports::read_study;
using reports::Study;

namespace {

// Studies of the same cells from perturbed starts, one a perturbation; fewer where interrupted.
std::vector<Study> perturbed_studies(const BaselineArguments& given, Session& session,
                                     const Study& study) {
  const RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                           .progress = Progress::style_of(STDERR_FILENO),
                           .command = session.command()};
  std::vector<Study> perturbed;
  for (int number = 1; number <= given.perturbations; ++number) {
    auto records = perturbed_records(session.catalog(), study.runs, number, options);
    if (!records) break;
    perturbed.emplace_back().runs = std::move(*records);
  }
  return perturbed;
}

}  // namespace

int baseline_verb(const BaselineArguments& given, Session& session) {
  Study study = read_study({given.folders.begin(), given.folders.end()});
  std::erase_if(study.runs, [](const Record& run) { return run.imported.has_value(); });
  require(!study.runs.empty(), "there are no records to remember");
  const std::vector<Study> perturbed = perturbed_studies(given, session, study);
  if (perturbed.size() < static_cast<std::size_t>(given.perturbations)) {
    say(stderr, "interrupted; no baseline was written\n");
    return kInterrupted;
  }
  const std::string text = baseline_json(study, perturbed);
  if (given.out.empty()) {
    say(stdout, text);
    return kGood;
  }
  const std::filesystem::path folder = std::filesystem::path(given.out).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  write_text(given.out, text);
  say(stdout, fmt::format("{}: {}\n", given.out, counted(study.runs.size(), "cell")));
  return kGood;
}

}  // namespace isoline::benchmarks
