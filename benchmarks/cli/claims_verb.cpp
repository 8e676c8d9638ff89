// isoline claims [ID...]: runs what published claims need, and judges them.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/reporting.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/run_plan.h"
#include "core/json.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::claim_section;
using reports::claims_json;
using reports::claims_section;
using reports::claims_summary;
using reports::counted;
using reports::joined;
using reports::Judgement;
using reports::kFewRows;
using reports::read_study;
using reports::terminal_claim;
using reports::terminal_section;
using reports::Verdict;
namespace {

std::string listed_by_groups(const std::vector<Claim>& claims, std::size_t most) {
  std::string text, group;
  for (const Claim& claim : std::span(claims).first(most)) {
    if (claim.group != group) text += claim.group + "\n";
    group = claim.group;
    text += fmt::format("  {:38} {}\n", claim.id, claim.sentence);
  }
  return text;
}

int list_claims(const std::vector<Claim>& claims, const ClaimArguments& given) {
  if (given.as_json) {
    say(stdout, fmt::format("{}\n", json_text(json_of(claims), 2)));
    return kGood;
  }
  std::vector<std::string> groups;
  for (const Claim& claim : claims)
    if (groups.empty() || groups.back() != claim.group) groups.push_back(claim.group);
  const std::size_t shown = given.lists_all ? claims.size() : std::min(kFewRows, claims.size());
  say(stdout, fmt::format("{} in {}: {}\n\n{}", counted(claims.size(), "claim"),
                          counted(groups.size(), "group"), joined(groups),
                          listed_by_groups(claims, shown)));
  if (shown < claims.size())
    say(stdout, fmt::format("… and {} more; --all lists them\n", claims.size() - shown));
  return kGood;
}

Outcome run_missing(const ClaimArguments& given, const std::vector<Claim>& claims,
                    Session& session) {
  RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                     .command = session.command()};
  if (!given.as_json) options.progress = Progress::style_of(STDERR_FILENO);
  const Outcome outcome =
      run_plan(session.catalog(), "claims", cells_of(claims, given.with_long), given.out, options);
  print_failures(outcome, given.out);
  if (!given.as_json && outcome.run > 0)
    say(stderr, fmt::format("{} run, {} reused in {}\n", counted(std::size_t(outcome.run), "cell"),
                            outcome.reused, duration_text(outcome.seconds)));
  return outcome;
}

// One claim with all that decides it; of several the verdicts.
std::string terminal_text_of(const std::vector<Judgement>& judgements, bool lists_all) {
  if (judgements.size() == 1) return terminal_claim(claim_section(judgements[0]));
  const std::string text = lists_all ? terminal_section(claims_section(judgements))
                                     : terminal_section(claims_summary(judgements), kFewRows);
  return text + "`isoline claims ID` shows one of them with the figures that decide it.\n";
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
  if (given.is_list) return list_claims(claims, given);
  Outcome outcome;
  if (!given.no_run) outcome = run_missing(given, claims, session);
  const std::vector<Judgement> judgements = judged(claims, read_study({given.out}).runs);
  say(stdout, given.as_json ? json_text(claims_json(judgements), 2) + "\n"
                            : terminal_text_of(judgements, given.lists_all));
  const int of_runs = exit_code_of(outcome);
  return of_runs == kGood ? exit_code_of(judgements) : of_runs;
}

}  // namespace isoline::benchmarks
