// Words the one-sentence readings of the charts.
#include "reports/readings.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/html/curves.h"
#include "reports/text.h"

namespace isoline::reports {
namespace {

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
  return fmt::format("{}", fmt::join(names, " and "));
}

std::string multiple(Real ratio) { return fmt::format("{:.3g}×", ratio); }

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
  const Spread& best = c.cell(problem, first).work[kTightest];
  const Spread& next = c.cell(problem, second).work[kTightest];
  const std::string name = shown_spec(c.optimizers[second].label);
  if (next.median <= best.median) return fmt::format(", tied with {}", name);
  return fmt::format("; next {}, {} as much{}", name,
                     multiple(next.median / std::max(best.median, 1.0)),
                     best.n > 1 && best.high >= next.low ? ", their ranges overlapping" : "");
}

}  // namespace

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
    text += fmt::format("; but it sees what others do not: {}", fmt::join(first.privileges, ", "));
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
  const std::string_view tau = kTolerances[tolerance].name;
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
  const auto work = [&](std::size_t s) { return c.cell(problem, s).work[kTightest]; };
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

std::string path_reading(const Comparison& c, std::size_t problem,
                         std::vector<std::vector<Real>> Path::*rows) {
  std::vector<Path> all = paths(c, problem);
  std::erase_if(all, [rows](const Path& path) { return detour(path.*rows) == kNever; });
  if (all.size() < 2) return "";
  const auto length = [rows](const Path& path) { return detour(path.*rows); };
  const auto [straight, winding] = std::ranges::minmax(all, {}, length);
  constexpr Real kStraight = 1.0005;
  const Real least = length(straight);
  return fmt::format(
      "Straightest: {}, {}. Longest way round: {}, {} the direct distance.",
      shown_spec(straight.optimizer),
      least < kStraight ? "a straight line" : multiple(least) + " the direct distance",
      shown_spec(winding.optimizer), multiple(length(winding)));
}

}  // namespace isoline::reports
