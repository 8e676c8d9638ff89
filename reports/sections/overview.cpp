// The first sentences of a report, and the sentences that read its charts.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/results/ranking.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// Methods, however many meanings each has: all, or those that were run on a problem.
std::size_t methods_of(const Comparison& c, std::optional<std::size_t> problem = {}) {
  std::set<std::string> names;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (!problem || c.cell(*problem, s).planned > 0) names.insert(c.optimizers[s].name_of_all());
  return names.size();
}

// "heat: 17, heat[N=16]: 12" where some problems were not asked of every optimizer; else empty.
std::string partial_rows(const Comparison& c) {
  constexpr std::size_t kNamed = 8;
  std::vector<std::string> rows;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const std::size_t planned = methods_of(c, p);
    if (planned < methods_of(c))
      rows.push_back(fmt::format("{}: {}", problem_name(c.problems[p]), planned));
  }
  const std::size_t more = rows.size() > kNamed ? rows.size() - kNamed : 0;
  rows.resize(rows.size() - more);
  return fmt::format("{}{}", joined(rows), more > 0 ? fmt::format(" and {} more", more) : "");
}

// The solvers with the greatest share within a factor, joined; many are counted, not named.
std::string leaders(const Comparison& c, const Profile& profile, Real factor, Real& share) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names;
  share = 0;
  for (const std::size_t s : c.order.methods) {
    const Real mine = profile.share(s, factor);
    if (mine > share) names.clear();
    share = std::max(share, mine);
    if (mine == share) names.push_back(shown_spec(c.optimizers[s].label));
  }
  if (names.size() > kNamed) return fmt::format("{} methods", names.size());
  return joined(names, " and ");
}

std::string unsolved_text(std::size_t unsolved, std::size_t applicable) {
  if (unsolved == 0) return fmt::format(" All {} methods reach it.", applicable);
  return fmt::format(" {} of {} methods {} not reach it.", unsolved, applicable,
                     unsolved == 1 ? "does" : "do");
}

std::string least_loss_reading(const Comparison& c, std::size_t problem,
                               const std::vector<std::size_t>& order) {
  const std::size_t best = *std::ranges::min_element(
      order, {}, [&](std::size_t s) { return c.cell(problem, s).loss.median; });
  const Real loss = c.cell(problem, best).loss.median;
  if (loss == kNever)
    return fmt::format("No method reaches {}, and none ends at a finite loss.", tau_name(c));
  return fmt::format("No method reaches {}; {} ends at the least median loss, {}.", tau_name(c),
                     shown_spec(c.optimizers[best].label), figure(loss));
}

// "more on 2 of 3 seeds": of the seeds that both ran, those where the first took less.
std::string seeds_text(const Comparison& c, const Cell& first, const Cell& second) {
  const auto pairs = c.join(first.runs, second.runs, [](const Run& run) { return run.seed; });
  const auto is_less = [&](const auto& pair) {
    return c.taken(c.runs[pair.first], c.yardstick.by, kTightest) <
           c.taken(c.runs[pair.second], c.yardstick.by, kTightest);
  };
  return pairs.size() < 2 ? ""
                          : fmt::format(", more on {} of {} seeds",
                                        std::ranges::count_if(pairs, is_less), pairs.size());
}

// "; next adam, 1.3× as much", and on how many seeds that is so.
std::string runner_up(const Comparison& c, std::size_t problem, std::size_t first,
                      std::size_t second) {
  const Spread& best = c.cell(problem, first).headline[kTightest];
  const Spread& next = c.cell(problem, second).headline[kTightest];
  const std::string name = shown_spec(c.optimizers[second].label);
  if (next.median <= best.median) return fmt::format(", tied with {}", name);
  const Real unit = least_unit(c.yardstick.by);
  return fmt::format("; next {}, {} as much{}", name,
                     multiple(next.median / std::max(best.median, unit)),
                     seeds_text(c, c.cell(problem, first), c.cell(problem, second)));
}

}  // namespace

std::string missing_text(const Comparison& comparison) {
  constexpr std::size_t kNamed = 5;
  const auto& missing = comparison.missing;
  if (missing.empty()) return "";
  std::string text =
      fmt::format("{} of {} cells, missing: ", comparison.answered, comparison.planned);
  for (std::size_t i = 0; i < missing.size() && i < kNamed; ++i)
    text += fmt::format("{}{} / {} / seed {}", i == 0 ? "" : "; ", missing[i].problem,
                        missing[i].optimizer, missing[i].seed);
  if (missing.size() > kNamed) text += fmt::format("; and {} more", missing.size() - kNamed);
  return text;
}

std::string headline(const Comparison& c) {
  std::string problems = counted(c.names, "problem");
  if (c.problems.size() > c.names) problems += fmt::format(" ({} settings)", c.problems.size());
  return fmt::format("{} on {}, {}, {}", counted(methods_of(c), "optimizer"), problems,
                     counted(c.seeds.size(), "seed"), counted(c.study->runs.size(), "run"));
}

// Whose claims stand among the runs: "Imported, marked §: theirs (Table 2 of …). …".
std::string imported_text(const Comparison& c) {
  std::map<std::string, std::set<std::string>> sources;  // by method
  for (const Run& run : c.runs)
    if (run.record->imported)
      sources[run.record->request.optimizer.name].insert(run.record->imported->source);
  if (sources.empty()) return "";
  std::vector<std::string> named;
  for (const auto& [method, those] : sources)
    named.push_back(fmt::format("{} ({})", method, joined({those.begin(), those.end()}, "; ")));
  return fmt::format(
      "Imported, marked §: {}. They are judged by their own figures; nothing of them was run or "
      "verified "
      "here, and their times are those of other machines.",
      joined(named));
}

std::vector<std::string> remarks(const Comparison& c) {
  std::vector<std::string> all;
  const Study& study = *c.study;
  if (const std::string rows = partial_rows(c); !rows.empty())
    all.push_back(fmt::format(
        "Not every optimizer ran on every problem: for example, a grid can be too large for "
        "methods "
        "that factorize a matrix or take no derivatives. An empty cell was not planned. Methods "
        "are "
        "ranked on the {} common to all ranked methods. Optimizers per problem, of {}: {}.",
        counted(c.order.settings.size(), setting_noun(c)), methods_of(c), rows));
  if (study.superseded > 0)
    all.push_back(fmt::format("Left aside: {} of the same cells.",
                              counted(study.superseded, "older result")));
  if (!study.unreadable.empty())
    all.push_back(fmt::format("Unreadable: {}, listed under failures.",
                              counted(study.unreadable.size(), "file")));
  if (c.is_any_timed_together)
    all.push_back("Times marked ≈ were taken while other runs shared the machine: not comparable.");
  if (const std::string imported = imported_text(c); !imported.empty()) all.push_back(imported);
  for (const ProblemAxis& problem : c.problems)
    if (!problem.is_minimum_declared)
      all.push_back(fmt::format(
          "{} declares no least loss: its tolerances refer to the best loss any run reached.",
          problem_name(problem)));
  return all;
}

std::string profile_reading(const Comparison& c, std::size_t tolerance) {
  const Profile& profile = c.profiles[tolerance];
  Real near = 0, ever = 0;
  const std::string fast = leaders(c, profile, 2, near), robust = leaders(c, profile, kNever, ever);
  const std::string_view tau = c.yardstick.tolerances[tolerance].name;
  if (ever == 0) return fmt::format("No method solves any of its problems to {}.", tau);
  return fmt::format(
      "{} {} {} of {} problems to {} within 2× of the least {}; the most at any price is {}, by "
      "{}.",
      fast, fast.find(' ') == std::string::npos ? "solves" : "solve", percent(near),
      fast.find(' ') == std::string::npos ? "its" : "their", tau, counted_name(c), percent(ever),
      robust);
}

std::string curve_reading(const Comparison& c, std::size_t problem) {
  const std::vector<std::size_t> order = ranking(c, problem);
  if (order.empty()) return "Nothing has run on this problem.";
  const auto work = [&](std::size_t s) { return c.cell(problem, s).headline[kTightest]; };
  const auto solved = static_cast<std::size_t>(
      std::ranges::count_if(order, [&](std::size_t s) { return work(s).is_solved(); }));
  if (solved == 0) return least_loss_reading(c, problem, order);
  const Spread first = work(order[0]);
  const std::string range =
      range_figure(first, c.yardstick.by == Measure::time ? milliseconds : reached_figure);
  std::string text = fmt::format("Least median {} to {}: {}, {}{} {}{}", counted_name(c),
                                 tau_name(c), shown_spec(c.optimizers[order[0]].label),
                                 c.cell(problem, order[0]).is_bound[kTightest] ? "≤ " : "",
                                 amount(c, first.median), unit_name(c),
                                 range.empty() ? "" : fmt::format(" ({} over seeds)", range));
  if (solved > 1) text += runner_up(c, problem, order[0], order[1]);
  return text + "." + unsolved_text(order.size() - solved, order.size());
}

// The learned problems, at equal work.

namespace {

// On how many of the learned problems each is nearest in x, those with the most first.
std::string nearest_text(const std::map<std::string, std::size_t>& nearest, std::size_t problems) {
  std::vector<std::pair<std::string, std::size_t>> ranked(nearest.begin(), nearest.end());
  std::ranges::stable_sort(ranked, std::ranges::greater{},
                           &std::pair<std::string, std::size_t>::second);
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> parts;
  for (const auto& [name, count] : ranked)
    if (parts.size() < kNamed) parts.push_back(fmt::format("{} on {}", name, count));
  return fmt::format("At equal work, of {}, nearest in x: {}.",
                     counted(problems, "learned problem"), joined(parts));
}

}  // namespace

std::vector<std::string> learned_sentences(const Comparison& c) {
  constexpr std::size_t kFew = 4;
  std::vector<std::string> all;
  std::map<std::string, std::size_t> nearest;
  std::size_t problems = 0;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    const EqualWork equal = equal_work(c, p);
    const auto order = equal.nearest_first();
    if (order.empty() || !equal.methods[order[0]]->x_error.is_solved()) continue;
    ++problems;
    ++nearest[optimizer_text(c, order[0])];
    const Real least = equal.methods[order[0]]->x_error.median;
    std::string text =
        fmt::format("{}, learned: at equal work {} is nearest in x, at {}",
                    problem_name(c.problems[p]), optimizer_text(c, order[0]), figure(least));
    if (const std::size_t diverged = equal.methods[order[0]]->diverged; diverged > 0)
      text += fmt::format(" (last finite value of {} that diverged)", counted(diverged, "run"));
    if (order.size() > 1)
      text += fmt::format("; next {}, {} as far", optimizer_text(c, order[1]),
                          multiple(equal.methods[order[1]]->x_error.median / least));
    if (all.size() < kFew) all.push_back(text + ".");
  }
  if (problems > 1) all.insert(all.begin(), nearest_text(nearest, problems));
  return all;
}

}  // namespace isoline::reports
