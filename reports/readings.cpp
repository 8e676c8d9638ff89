// Words the one-sentence readings of the charts.
#include "reports/readings.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/curves.h"
#include "reports/text.h"

namespace isoline {
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
    if (mine == share) names.push_back(c.optimizers[s].label);
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
                     c.optimizers[best].label, figure(loss));
}

}  // namespace

std::string profile_reading(const Comparison& c, std::size_t tolerance) {
  const Profile& profile = c.profiles[tolerance];
  Real near = 0, ever = 0;
  const std::string fast = leaders(c, profile, 2, near), robust = leaders(c, profile, kNever, ever);
  const std::string_view tau = kTolerances[tolerance].name;
  if (ever == 0) return fmt::format("No method solves any of the problems to {}.", tau);
  const std::size_t n = profile.problems;
  return fmt::format(
      "{} {} {} of the {} problem{} to {} within 2× of the least work; the most at any price is "
      "{}, "
      "by {}.",
      fast, fast.find(' ') == std::string::npos ? "solves" : "solve", percent(near), n,
      n == 1 ? "" : "s", tau, percent(ever), robust);
}

std::string curve_reading(const Comparison& c, std::size_t problem) {
  const std::vector<std::size_t> order = ranking(c, problem);
  if (order.empty()) return "Nothing has run on this problem.";
  const auto work = [&](std::size_t s) { return c.cell(problem, s).work[kTightest].median; };
  const auto solved = static_cast<std::size_t>(
      std::ranges::count_if(order, [&](std::size_t s) { return work(s) < kNever; }));
  if (solved == 0) return least_loss_reading(c, problem, order);
  std::string text = fmt::format("Least median work to 1e-6: {}, {} forward solves",
                                 c.optimizers[order[0]].label, figure(work(order[0])));
  if (solved > 1 && work(order[1]) > work(order[0]))
    text += fmt::format("; next {}, {} as much", c.optimizers[order[1]].label,
                        multiple(work(order[1]) / std::max(work(order[0]), 1.0)));
  else if (solved > 1)
    text += fmt::format(", tied with {}", c.optimizers[order[1]].label);
  return text + "." + unsolved_text(order.size() - solved, order.size());
}

std::string path_reading(const Comparison& c, std::size_t problem) {
  std::vector<Path> all = paths(c, problem);
  std::erase_if(all, [](const Path& path) { return detour(path.x) == kNever; });
  if (all.size() < 2) return "";
  const auto length_in_x = [](const Path& path) { return detour(path.x); };
  const auto [straight, winding] = std::ranges::minmax(all, {}, length_in_x);
  return fmt::format(
      "In x space {} runs straightest, {} the distance between its ends; {} takes the longest "
      "way, "
      "{}.",
      straight.optimizer, multiple(detour(straight.x)), winding.optimizer,
      multiple(detour(winding.x)));
}

}  // namespace isoline
