// isoline claims [ID...]: runs what published claims need, and judges them.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/reporting.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/run_plan.h"
#include "core/json.h"
#include "core/text.h"

namespace isoline::benchmarks {

using reports::claim_section;
using reports::claims_json;
using reports::claims_section;
using reports::Judgement;
using reports::read_study;
using reports::terminal_claim;
using reports::terminal_section;
using reports::Verdict;
namespace {

int list_claims(const std::vector<Claim>& claims, bool as_json) {
  if (as_json) {
    say(stdout, fmt::format("{}\n", json_text(json_of(claims), 2)));
    return kGood;
  }
  std::string group;
  for (const Claim& claim : claims) {
    if (claim.group != group) say(stdout, fmt::format("{}\n", claim.group));
    group = claim.group;
    say(stdout, fmt::format("  {:38} {}\n", claim.id, claim.sentence));
  }
  return kGood;
}

Outcome run_missing(const ClaimArguments& given, const std::vector<Claim>& claims,
                    Session& session) {
  RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                     .command = session.command()};
  if (!given.as_json) options.progress = Progress::style_of(STDERR_FILENO);
  const Outcome outcome =
      run_plan(session.catalog(), "claims", cells_of(claims, given.with_long), given.out, options);
  for (const std::string& failure : outcome.failures) say(stderr, fmt::format("{}\n", failure));
  return outcome;
}

// One claim with all that decides it; of several the verdicts.
std::string terminal_text_of(const std::vector<Judgement>& judgements) {
  if (judgements.size() == 1) return terminal_claim(claim_section(judgements[0]));
  return terminal_section(claims_section(judgements)) +
         "`isoline claims ID` shows one of them with the figures that decide it.\n";
}

int exit_code_of(const std::vector<Judgement>& judgements) {
  const auto has = [&](auto&& is_so) {
    return std::ranges::any_of(judgements, is_so, &Judgement::verdict);
  };
  if (has([](Verdict verdict) { return verdict == Verdict::not_reproduced; })) return kWorse;
  return has(reports::is_decided) ? kGood : kNotComparable;
}

}  // namespace

int claims_verb(const ClaimArguments& given, Session& session) {
  const std::vector<Claim> claims =
      chosen_claims(builtin_claims_of(session.catalog()), given.names);
  if (given.is_list) return list_claims(claims, given.as_json);
  Outcome outcome;
  if (!given.no_run) outcome = run_missing(given, claims, session);
  const std::vector<Judgement> judgements = judged(claims, read_study({given.out}).runs);
  say(stdout,
      given.as_json ? json_text(claims_json(judgements), 2) + "\n" : terminal_text_of(judgements));
  const int of_runs = exit_code_of(outcome);
  return of_runs == kGood ? exit_code_of(judgements) : of_runs;
}

}  // namespace isoline::benchmarks
