// isoline claims [ID...]: runs what published claims need, and judges them.
#include "reports/report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/claim_cells.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/sheets.h"
#include "core/errors.h"

namespace isoline::benchmarks {

using reports::claims_json;
using reports::claims_section;
using reports::judge;
using reports::Judgement;
using reports::read_study;
using reports::Study;
using reports::terminal_section;
using reports::Verdict;
namespace {

struct ClaimArguments {
  std::vector<std::string> names;
  std::string out = "results/claims";
  int jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool is_list = false, as_json = false, no_run = false, with_long = false;
};

void list_claims(const std::vector<Claim>& claims, bool as_json) {
  if (as_json) return fmt::print("{}\n", json_of(claims).dump(2));
  std::string group;
  for (const Claim& claim : claims) {
    if (claim.group != group) fmt::print("{}\n", claim.group);
    group = claim.group;
    fmt::print("  {:38} {}\n", claim.id, claim.sentence);
  }
}

// Whether all cells have a record that went well.
bool run_missing(const ClaimArguments& given, const std::vector<Claim>& claims, Session& session) {
  const std::vector<Request> requests = cells_of(claims, given.with_long);
  RunOptions options{.jobs = given.jobs, .command = session.command()};
  if (!given.as_json) options.progress = Progress::style_of(STDERR_FILENO);
  Store store(given.out);
  store.plan("claims", planned_cells(requests));
  write_sheets(session.catalog(), requests, store);
  const Outcome outcome = run_all(session.catalog(), requests, store, options);
  for (const std::string& failure : outcome.failures) fmt::print(stderr, "{}\n", failure);
  if (outcome.is_interrupted) session.exit_code = kInterrupted;
  return outcome.failures.empty();
}

int exit_code_of(const std::vector<Judgement>& judgements) {
  const auto has = [&](Verdict verdict) {
    return std::ranges::find(judgements, verdict, &Judgement::verdict) != judgements.end();
  };
  if (has(Verdict::not_reproduced)) return kWorse;
  return has(Verdict::reproduced) || has(Verdict::partly) ? kGood : kNotComparable;
}

void judge_claims(const ClaimArguments& given, Session& session) {
  const std::vector<Claim> claims =
      chosen_claims(builtin_claims_of(session.catalog()), given.names);
  if (given.is_list) return list_claims(claims, given.as_json);
  const bool is_sound = given.no_run || run_missing(given, claims, session);
  const Study study = read_study({given.out});
  const std::vector<Judgement> judgements = judge(json_of(claims), study.runs);
  fmt::print("{}",
             given.as_json ? claims_json(judgements).dump(2) + "\n" : terminal_section(claims_section(judgements)));
  if (session.exit_code == kInterrupted) return;
  session.exit_code = is_sound ? exit_code_of(judgements) : kWorse;
}

}  // namespace

std::vector<Judgement> covered_claims(Session& session, const Study& study) {
  std::vector<Judgement> judgements =
      judge(json_of(builtin_claims_of(session.catalog())), study.runs);
  std::erase_if(judgements, [](const Judgement& judgement) { return !judgement.is_covered; });
  return judgements;
}

void add_claims(CLI::App& app, Session& session) {
  const auto given = std::make_shared<ClaimArguments>();
  CLI::App* verb = app.add_subcommand(
      "claims", "Judge what papers claim, by runs; what is missing is run first");
  verb->add_option("ID", given->names, "Claims, or groups of them (default: all)");
  verb->add_option("--out", given->out, "Result folder that holds the runs")->capture_default_str();
  verb->add_option("--jobs", given->jobs, "Cells at a time (default: one a core)")
      ->check(CLI::Range(1, 1024));
  verb->add_flag("--list", given->is_list, "List the claims, and do nothing");
  verb->add_flag("--json", given->as_json, "As JSON");
  verb->add_flag("--no-run", given->no_run, "Judge by the runs that are there");
  verb->add_flag("--long", given->with_long, "Run also what takes hours");
  verb->footer(
      "A claim is reproduced where what is measured lies within the source's own error of "
      "reading,\n"
      "partly where only the direction holds. --out results/quick judges the runs of a suite.\n"
      "Exit codes: 0 good, 2 a claim is not reproduced or a run failed, 4 none can be compared.");
  verb->callback([given, &session] { judge_claims(*given, session); });
}

}  // namespace isoline::benchmarks
