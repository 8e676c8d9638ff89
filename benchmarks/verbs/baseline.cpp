// isoline baseline RESULTS: writes one small file with which later results are compared, or with
// --best the lowest losses for problems that do not declare a least loss.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/rates.h"
#include "benchmarks/run/runner.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/output.h"
#include "core/results/study.h"
#include "core/seeds.h"
#include "core/text.h"
#include "reports/compare/gate.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct BaselineArguments {
  std::vector<std::string> folders;
  std::string out, best;
  int perturbations = 2, jobs = 0;
  bool trust = false;
};

void declare(VerbArguments& verb, BaselineArguments& given) {
  verb.texts("RESULTS", given.folders, "Result folders of `isoline run`").required();
  const Argument out =
      verb.text("--out", given.out, "The baseline file (default: standard output)");
  verb.text("--best", given.best,
            "Instead of a baseline: the table of lowest losses to write or to extend, such as "
            "benchmarks/best.json; the lower of two losses is kept")
      .excludes(out);
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

std::vector<Record> records_under(const std::vector<std::string>& folders) {
  std::vector<Record> records;
  for (const fs::path folder : folders) {
    require(fs::exists(folder / "runs"), [&] {
      return folder.string() + " is not a result folder; `isoline run --out FOLDER` creates one";
    });
    for (const auto& entry : fs::directory_iterator(folder / "runs"))
      if (entry.path().extension() == ".json") records.push_back(read_record(entry.path()));
  }
  require(!records.empty(), "no records in these folders; `isoline run --out FOLDER` creates some");
  return records;
}

// One row per line, so that a diff of the table is readable.
std::string best_losses_text(const Json& table) {
  std::string rows;
  for (const Json& row : table.at("rows")) rows += (rows.empty() ? "" : ",\n") + json_text(row);
  return fmt::format("{{\"schema\": {}, \"rows\": [\n{}\n]}}\n", json_text(table.at("schema")),
                     rows);
}

// Writes or extends the table of lowest losses.
int extend_best(const BaselineArguments& given, Session& session) {
  make_output_folder(fs::path(given.best).parent_path());
  BestLosses best;
  if (fs::exists(given.best)) best = BestLosses::from_json(read_json(given.best), given.best);
  std::map<std::string, bool> declares;  // by problem, whether it knows its least loss
  std::set<std::pair<std::string, std::uint64_t>> improved;  // problems and instances
  for (const Record& record : records_under(given.folders)) {
    const Component& problem = record.request.problem;
    if (!session.catalog().problems.contains(problem.name)) continue;
    const auto [known, is_new] = declares.try_emplace(problem.spec, false);
    if (is_new) known->second = record.minimum && !record.is_best_known;  // nothing is started
    if (!known->second && best.add(record))
      improved.emplace(problem.spec, instance_of(record.request.seed));
  }
  write_text(given.best, best_losses_text(best.to_json()));
  say(stdout, fmt::format("{}: best losses new or improved: {}\n", given.best, improved.size()));
  return kGood;
}

int run(const BaselineArguments& given, Session& session) {
  if (!given.best.empty()) return extend_best(given, session);
  reports::Study study = reports::read_study({given.folders.begin(), given.folders.end()});
  require(say_left_out(study.unreadable) == 0,
          "a baseline with holes would pass every later comparison; repeat `isoline run` for the "
          "records that were left out, or remove their files");
  std::erase_if(study.runs, [](const Record& run) { return run.imported.has_value(); });
  require(!study.runs.empty(),
          "no records in these folders; `isoline run --out FOLDER` creates some");
  if (!given.out.empty()) {
    make_output_folder(fs::path(given.out).parent_path());
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
  registry.add(verb_of<BaselineArguments>(
      {.name = "baseline",
       .help_position = 50,
       .summary = "Write a small file that later results are compared with, or the lowest losses "
                  "found",
       .examples = "  isoline baseline results/quick --out baseline.json\n"
                   "  isoline compare baseline.json results/quick\n"
                   "  isoline baseline results/quick --best benchmarks/best.json",
       .notes =
           "The file has one line per cell (one problem, one optimizer, one seed): its status, a "
           "digest of its curve, its final values, and the work needed to reach 1e-1, 1e-3 and "
           "1e-6.\n"
           "Each cell runs again from starting points that differ in the last bit. A cell is "
           "chaotic if its values then change by more than a tenth of the tolerance of `compare`. "
           "`compare` judges such cells by their status and by the tolerances 1e-1, 1e-3 and 1e-6 "
           "that they reach, so rounding alone is not a regression.\n"
           "Runs of the portable preset (ISOLINE_PRESET=portable) give the same baseline on "
           "every x86-64-v3 machine.\n"
           "If a problem does not declare its least attainable loss, tolerances refer to the lowest "
           "known loss. The table benchmarks/best.json is compiled into the program; `isoline run "
           "--best FILE` reads another one."},
      declare, run));
}

}  // namespace isoline::benchmarks
