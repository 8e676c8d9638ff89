// isoline claims [ID...]: runs the cells of published claims, and judges the claims.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/claim_cells.h"
#include "benchmarks/run/run_plan.h"
#include "core/json.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

namespace {

struct ClaimArguments {
  std::vector<std::string> names;
  std::string out = "results/claims";
  int jobs = 0;
  bool is_list = false, as_json = false, no_run = false, with_long = false, lists_all = false;
  bool as_papers = false, without_published = false;
};

void declare(VerbArguments& verb, ClaimArguments& given) {
  verb.texts("ID", given.names, "Claims or groups of claims (default: all)");
  verb.text("--out", given.out, "Result folder of the runs").shown();
  verb.whole("--jobs", given.jobs, "Number of cells at a time (default: one per core)", kJobs);
  verb.flag("--list", given.is_list, "List the claims, and run nothing");
  verb.flag("--all", given.lists_all, "List every claim, not the first 20");
  verb.flag("--json", given.as_json, "Print JSON");
  verb.flag("--papers", given.as_papers,
            "Print one Markdown table per paper, as in docs/papers.md");
  verb.flag("--no-run", given.no_run, "Judge only by existing runs");
  verb.flag("--without-published", given.without_published,
            "Do not use the records in benchmarks/published");
  verb.flag("--long", given.with_long, "Also run the cells that take hours");
}

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
  const std::size_t shown =
      given.lists_all ? claims.size() : std::min(reports::kFewRows, claims.size());
  say(stdout, fmt::format("{} in {}: {}\n\n{}", reports::counted(claims.size(), "claim"),
                          reports::counted(groups.size(), "group"), reports::joined(groups),
                          listed_by_groups(claims, shown)));
  if (shown < claims.size())
    say(stdout, fmt::format("… and {} more claim{}; --all lists them\n", claims.size() - shown,
                            claims.size() - shown == 1 ? "" : "s"));
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
    say(stderr,
        fmt::format("{} run, {} reused in {}\n", reports::counted(std::size_t(outcome.run), "cell"),
                    outcome.reused, duration_text(outcome.seconds)));
  return outcome;
}

// The evidence of a single claim, or the verdicts of several.
std::string terminal_text_of(const std::vector<reports::Judgement>& judgements, bool lists_all) {
  if (judgements.size() == 1)
    return reports::terminal_claim(reports::claim_section(judgements[0]), output_columns());
  const std::string text = lists_all
                               ? reports::terminal_section(reports::claims_section(judgements),
                                                           reports::kAllRows, output_columns())
                               : reports::terminal_section(reports::claims_summary(judgements),
                                                           reports::kFewRows, output_columns());
  return text + "`isoline claims ID` shows the evidence of one claim.\n";
}

std::string papers_page(const std::vector<reports::Judgement>& judgements) {
  return "# What do the papers claim, and what do the runs show?\n\n"
         "`./isoline claims --no-run --papers --out results/papers` writes this page, with one row "
         "per claim in `benchmarks/claims` and the command that decides it. The runs are those of "
         "a "
         "result folder. [Claims](claims.md) explains the verdicts.\n" +
         reports::markdown_section(reports::papers_section(judgements), reports::kAllRows) +
         reports::markdown_section(
             reports::items_section(parse_json(std::string(embedded_papers()), "papers")),
             reports::kAllRows);
}

// Published records are the same for all: only the reader's own runs can fail.
int exit_code_of(const std::vector<reports::Judgement>& judgements) {
  const auto has_failed = [](const reports::Judgement& one) {
    return one.verdict == reports::Verdict::differs && one.reached.empty();
  };
  if (std::ranges::any_of(judgements, has_failed)) return kWorse;
  const bool is_any_decided =
      std::ranges::any_of(judgements, reports::is_decided, &reports::Judgement::verdict);
  return is_any_decided ? kGood : kNotComparable;
}

// None of the default folder before its first run: then published records decide.
std::vector<Record> runs_of(const ClaimArguments& given) {
  std::error_code unknown;
  if (given.out == ClaimArguments{}.out && !std::filesystem::exists(given.out, unknown)) return {};
  return study_of({given.out}).runs;
}

int run(const ClaimArguments& given, Session& session) {
  const std::vector<Claim> claims = chosen_claims(session.claims(), given.names);
  if (given.is_list) return list_claims(claims, given);
  Outcome outcome;
  if (!given.no_run) outcome = run_missing(given, claims, session);
  const std::vector<reports::Judgement> judgements = reports::judge(
      json_of(claims), runs_of(given),
      given.without_published ? std::vector<Record>() : published_records(session.catalog()));
  say(stdout, given.as_json     ? json_text(reports::claims_json(judgements), 2) + "\n"
              : given.as_papers ? papers_page(judgements)
                                : terminal_text_of(judgements, given.lists_all));
  const int of_runs = exit_code_of(outcome);
  return of_runs == kGood ? exit_code_of(judgements) : of_runs;
}

}  // namespace

void register_claims(VerbRegistry& registry) {
  registry.add(verb_of<ClaimArguments>(
      {.name = "claims",
       .help_position = 110,
       .summary = "Judge the claims of papers by runs, after running the missing cells",
       .examples = R"(  isoline claims --list                          the claims and their sources
  isoline claims exponential                     one group of claims
  isoline claims sip-better-in-x-worse-in-loss   one claim, with its evidence
  isoline claims --no-run --out results/quick    only from the runs of a suite)",
       .notes =
           "A claim agrees if the published value lies within the error of one more run, and is "
           "reproduced if six or more runs show it; otherwise it differs, or the runs are too "
           "noisy, too short or a single one. It is partly so if one of two readings agrees.\n"
           "The program contains records of runs that take hours (benchmarks/published). They are "
           "used if the result folder lacks a run, and the evidence states their numbers of "
           "iterations and seeds.\n"
           "Exit codes: 0 success, 2 a claim differs or a run failed, 4 not comparable."},
      declare, run));
}

}  // namespace isoline::benchmarks
