// What a report says first, and the sentences that read its charts.
#include <fmt/format.h>

#include <algorithm>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// "heat: 17, heat[N=16]: 12" where some problems were not asked of every optimizer; else empty.
std::string partial_rows(const Comparison& c) {
  constexpr std::size_t kNamed = 8;
  std::vector<std::string> rows;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const auto planned =
        std::ranges::count_if(c.cells[p], [](const Cell& x) { return x.planned > 0; });
    if (static_cast<std::size_t>(planned) < c.optimizers.size())
      rows.push_back(fmt::format("{}: {}", shown_spec(c.problems[p].spec), planned));
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
  for (std::size_t s = 0; s < profile.solvers.size(); ++s) {
    const Real mine = profile.share(s, factor);
    if (mine > share) names.clear();
    share = std::max(share, mine);
    if (mine == share) names.push_back(shown_spec(c.optimizers[s].label));
  }
  if (names.size() > kNamed) return fmt::format("{} methods", names.size());
  return joined(names, " and ");
}

std::string unsolved_text(std::size_t unsolved, std::size_t applicable) {
  if (unsolved == 0) return fmt::format(" All {} methods get there.", applicable);
  return fmt::format(" {} of {} methods {} not get there.", unsolved, applicable,
                     unsolved == 1 ? "does" : "do");
}

std::string least_loss_reading(const Comparison& c, std::size_t problem,
                               const std::vector<std::size_t>& order) {
  const std::size_t best = *std::ranges::min_element(
      order, {}, [&](std::size_t s) { return c.cell(problem, s).loss.median; });
  const Real loss = c.cell(problem, best).loss.median;
  if (loss == kNever) return "No method reaches 1e-6, and none ends at a finite loss.";
  return fmt::format("No method reaches 1e-6; {} ends at the least median loss, {}.",
                     shown_spec(c.optimizers[best].label), figure(loss));
}

// "sip solves 16 of 18 problems to 1e-6, with the least work of all on 9; median 1.2× the least".
std::string deeds(const Comparison& c, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  const Standing& standing = optimizer.tightest();
  return fmt::format("{} solves {} of {} problem{} to 1e-6, {} of them with the least work of all",
                     shown_spec(optimizer.label), standing.solved, optimizer.planned,
                     optimizer.planned == 1 ? "" : "s", standing.wins);
}

std::string sureness(const Leader& leader) {
  constexpr Real kSure = 0.95;
  return fmt::format("Drawing the problems anew, it stays first in {} of draws: {}.",
                     percent(leader.stays_first),
                     leader.stays_first >= kSure ? "its lead is settled for problems like these"
                                                 : "its lead is not settled");
}

// "; next adam, 1.3× as much", and whether seeds could turn it round.
std::string runner_up(const Comparison& c, std::size_t problem, std::size_t first,
                      std::size_t second) {
  const Spread& best = c.cell(problem, first).headline[kTightest];
  const Spread& next = c.cell(problem, second).headline[kTightest];
  const std::string name = shown_spec(c.optimizers[second].label);
  if (next.median <= best.median) return fmt::format(", tied with {}", name);
  return fmt::format("; next {}, {} as much{}", name,
                     multiple(next.median / std::max(best.median, 1.0)),
                     best.n > 1 && best.high >= next.low ? ", their ranges overlapping" : "");
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
  return fmt::format("{} on {}, {}, {}", counted(c.optimizers.size(), "optimizer"), problems,
                     counted(c.seeds.size(), "seed"), counted(c.runs.size(), "run"));
}

std::vector<std::string> remarks(const Comparison& c) {
  std::vector<std::string> all;
  const Study& study = *c.study;
  if (const std::string rows = partial_rows(c); !rows.empty())
    all.push_back(fmt::format(
        "Not every problem was given to every optimizer, as where a grid is too large for methods "
        "that factorize a matrix or take no derivatives. An empty cell was never planned and counts "
        "for nobody: work is compared within one problem, and each optimizer is judged on the "
        "problems given to it. Optimizers by problem, of {}: {}.",
        c.optimizers.size(), rows));
  if (study.superseded > 0)
    all.push_back(
        fmt::format("{} older results of the same cells were left aside.", study.superseded));
  if (!study.unreadable.empty())
    all.push_back(fmt::format("{} files could not be read; they are listed under failures.",
                              study.unreadable.size()));
  if (c.is_any_timed_together)
    all.push_back("Times marked ≈ were taken while other runs shared the machine: not comparable.");
  for (const ProblemAxis& problem : c.problems)
    if (!problem.is_minimum_declared)
      all.push_back(fmt::format(
          "{} declares no least loss: its tolerances refer to the best loss any run reached.",
          shown_spec(problem.spec)));
  return all;
}

std::vector<std::string> verdict(const Comparison& c) {
  if (!c.leader) return {"No optimizer solves any of the problems to 1e-6."};
  const OptimizerAxis& first = c.optimizers[c.leader->optimizer];
  std::vector<std::string> all;
  if (c.names < kFewProblems) {  // no order over problems, but one on each
    for (std::size_t p = 0; p < c.problems.size() && p < kFewProblems; ++p)
      all.push_back(fmt::format("{}: {}", shown_spec(c.problems[p].spec), curve_reading(c, p)));
    return all;
  }
  std::string text = deeds(c, c.leader->optimizer);
  if (!first.privileges.empty())
    text += fmt::format("; but it sees what others do not: {}", joined(first.privileges));
  all.push_back(text + ". " + sureness(*c.leader));
  if (c.open_leader && c.open_leader->optimizer != c.leader->optimizer)
    all.push_back(fmt::format("Among those that see no more than they are given, {}. {}",
                              deeds(c, c.open_leader->optimizer), sureness(*c.open_leader)));
  return all;
}

std::string profile_reading(const Comparison& c, std::size_t tolerance) {
  const Profile& profile = c.profiles[tolerance];
  Real near = 0, ever = 0;
  const std::string fast = leaders(c, profile, 2, near), robust = leaders(c, profile, kNever, ever);
  const std::string_view tau = c.yardstick.tolerances[tolerance].name;
  if (ever == 0) return fmt::format("No method solves any of its problems to {}.", tau);
  return fmt::format(
      "{} {} {} of {} problems to {} within 2× of the least work; the most at any price is {}, by "
      "{}.",
      fast, fast.find(' ') == std::string::npos ? "solves" : "solve", percent(near),
      fast.find(' ') == std::string::npos ? "its" : "their", tau, percent(ever), robust);
}

std::string curve_reading(const Comparison& c, std::size_t problem) {
  const std::vector<std::size_t> order = ranking(c, problem);
  if (order.empty()) return "Nothing has run on this problem.";
  const auto work = [&](std::size_t s) { return c.cell(problem, s).headline[kTightest]; };
  const auto solved = static_cast<std::size_t>(
      std::ranges::count_if(order, [&](std::size_t s) { return work(s).is_solved(); }));
  if (solved == 0) return least_loss_reading(c, problem, order);
  const std::string range = range_figure(work(order[0]), reached_figure);
  std::string text =
      fmt::format("Least median work to 1e-6: {}, {} forward solves{}",
                  shown_spec(c.optimizers[order[0]].label), figure(work(order[0]).median),
                  range.empty() ? "" : fmt::format(" ({} over seeds)", range));
  if (solved > 1) text += runner_up(c, problem, order[0], order[1]);
  return text + "." + unsolved_text(order.size() - solved, order.size());
}

}  // namespace isoline::reports
