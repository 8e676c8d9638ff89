// Holds the figures of two subjects to each other.
#include "reports/compare/differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/digest.h"
#include "core/draws.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kRounding = 1e-16;   // of double precision, as a share of the problem's scale
constexpr Real kSummation = 1e-12;  // relative: sums of some thousand numbers in another order
constexpr Real kSmallest = 1e-6;    // share of the scale below which values are as good as solved

// Not-a-number is no better than infinite.
Real finite_or_never(Real value) { return std::isnan(value) ? kNever : value; }

// As a share of |before|, or of the smallest value that counts, above what rounding explains.
Real least_tolerance(Real before, Real after, Real scale) {
  if (before == after) return 0;
  if (!std::isfinite(before) || !std::isfinite(after)) return kNever;
  const Real size = std::isfinite(scale) ? std::abs(scale) : 0;
  const Real excess = std::abs(after - before) - kRounding * size;
  if (excess <= 0) return 0;
  const Real unit = std::max(std::abs(before), kSmallest * size);
  return unit == 0 ? kNever : excess / unit;
}

bool agree(Real before, Real after, Real scale, const std::optional<Real>& tolerance) {
  if (!tolerance) return before == after;
  return least_tolerance(before, after, scale) <= *tolerance;
}

Real relative_change(Real before, Real after) {
  if (!std::isfinite(before) || !std::isfinite(after) || before == 0)
    return after > before ? kNever : -kNever;
  return (after - before) / std::abs(before);
}

Difference difference_of(const Subject& subject, const Quantity& quantity, Real before,
                         Real after) {
  const bool looks_equal = reached_figure(before) == reached_figure(after);
  const auto text = [&](Real value) {
    return looks_equal ? exact_figure(value) : reached_figure(value);
  };
  return {.change = after > before ? Change::worse : Change::better,
          .key = subject.key,
          .title = subject.title,
          .problem = subject.problem.name,
          .optimizer = subject.optimizer.name,
          .what = quantity.name,
          .before = text(before),
          .after = text(after),
          .relative = relative_change(before, after),
          .note = "",
          .cause = "",
          .is_rounding = least_tolerance(before, after, quantity.scale) <= kSummation};
}

// One line a group and direction: the largest, with how many more there are.
void keep_largest(std::map<std::pair<std::string, Change>, std::pair<Difference, int>>& largest,
                  const std::string& group, Difference difference) {
  const auto key = std::pair(group, difference.change);
  const auto at = largest.find(key);
  if (at == largest.end()) {
    largest.emplace(key, std::pair(std::move(difference), 0));
    return;
  }
  auto& [kept, more] = at->second;
  ++more;
  if (std::abs(difference.relative) > std::abs(kept.relative)) kept = std::move(difference);
}

// Of each quantity that both have: it, before; its values before and after.
template <class Visit>
void compare_figures(const Subject& a, const Subject& b, Visit visit) {
  std::map<std::string_view, const Quantity*> before;
  for (const Quantity& quantity : a.quantities) before[*quantity.name] = &quantity;
  for (const Quantity& quantity : b.quantities) {
    const auto at = before.find(*quantity.name);
    if (at == before.end()) continue;
    visit(*at->second, finite_or_never(at->second->value), finite_or_never(quantity.value));
  }
}

}  // namespace

Real movement(const Subject& a, const Subject& b) {
  if (a.state != b.state) return kNever;
  Real most = 0;
  compare_figures(a, b, [&](const Quantity& quantity, Real before, Real after) {
    most = std::max(most, least_tolerance(before, after, quantity.scale));
  });
  return most;
}

std::vector<Difference> quantity_differences(const Subject& a, const Subject& b,
                                             const std::optional<Real>& tolerance) {
  std::map<std::pair<std::string, Change>, std::pair<Difference, int>> largest;
  compare_figures(a, b, [&](const Quantity& quantity, Real before, Real after) {
    if (!agree(before, after, quantity.scale, tolerance))
      keep_largest(largest, quantity.group, difference_of(a, quantity, before, after));
  });
  std::vector<Difference> out;
  for (auto& [key, kept] : largest) {
    auto& [difference, more] = kept;
    if (more > 0) difference.note = fmt::format("and {} more of its kind", more);
    out.push_back(std::move(difference));
  }
  return out;
}

Difference state_difference(const Subject& a, const Subject& b) {
  const Change change = b.badness > a.badness   ? Change::worse
                        : b.badness < a.badness ? Change::better
                                                : Change::changed;
  return {.change = change,
          .key = a.key,
          .title = a.title,
          .problem = a.problem.name,
          .optimizer = a.optimizer.name,
          .what = "status",
          .before = a.state,
          .after = b.state,
          .relative = change == Change::changed ? 0 : Real(b.badness - a.badness) * kNever,
          .note = "",
          .cause = ""};
}

// Judges chaotic results by their status and their coarse targets.

namespace {

// Another processor rounds in every operation, a perturbed start once: cells that moved by nearly
// the tolerance when perturbed move beyond it elsewhere.
constexpr Real kMargin = 0.1;

using Tolerances = std::array<bool, kTolerances.size()>;

// In the sense of the aim that BASE knows of.
Tolerances reached_by(const Subject& subject, Aim aim) {
  Tolerances reached{};
  for (std::size_t t = 0; t < reached.size(); ++t)
    reached[t] = work_to(subject, aim, kTolerances[t].tau) < kNever;
  return reached;
}

Difference difference_in(const Subject& subject, Change change) {
  return {.change = change,
          .key = subject.key,
          .title = subject.title,
          .problem = subject.problem.name,
          .optimizer = subject.optimizer.name,
          .what = "",
          .before = "",
          .after = "",
          .relative = 0,
          .note = "chaotic: judged by status and coarse targets",
          .cause = ""};
}

std::optional<Difference> status_difference(const Subject& before, const Subject& after) {
  std::set<std::string> seen(before.perturbed->states.begin(), before.perturbed->states.end());
  seen.insert(before.state);
  if (seen.contains(after.state)) return std::nullopt;
  int least = before.badness, most = before.badness;
  for (const std::string& state : before.perturbed->states) {
    const int badness = badness_of(status_named(state));
    least = std::min(least, badness);
    most = std::max(most, badness);
  }
  const Change change = after.badness > most    ? Change::worse
                        : after.badness < least ? Change::better
                                                : Change::changed;
  Difference difference = difference_in(before, change);
  difference.what = "status";
  difference.before = joined({seen.begin(), seen.end()}, " or ");
  difference.after = after.state;
  if (change != Change::changed) difference.relative = change == Change::worse ? kNever : -kNever;
  return difference;
}

}  // namespace

Perturbed perturbed_of(const Subject& unperturbed, const std::vector<Subject>& perturbed) {
  Perturbed found;
  for (const Subject& subject : perturbed) {
    found.moved = std::max(found.moved, movement(unperturbed, subject));
    found.states.push_back(subject.state);
    const Tolerances reached = reached_by(subject, unperturbed.aim);
    for (std::size_t t = 0; t < reached.size(); ++t) found.reached[t] += reached[t];
  }
  return found;
}

bool is_chaotic(const Subject& subject, const std::optional<Real>& tolerance) {
  return tolerance && subject.perturbed && subject.perturbed->moved > kMargin * *tolerance;
}

std::vector<Difference> coarse_differences(const Subject& before, const Subject& after) {
  std::vector<Difference> all;
  if (auto difference = status_difference(before, after)) all.push_back(std::move(*difference));
  const Tolerances then = reached_by(before, before.aim), now = reached_by(after, before.aim);
  const Perturbed& others = *before.perturbed;
  for (std::size_t t = 0; t < now.size(); ++t) {
    const bool by_all = then[t] && others.reached[t] == others.states.size();
    const bool by_none = !then[t] && others.reached[t] == 0;
    if (now[t] ? !by_none : !by_all) continue;
    Difference difference = difference_in(before, now[t] ? Change::better : Change::worse);
    difference.what = fmt::format("target {}", kTolerances[t].name);
    difference.before = now[t] ? "missed" : "reached";
    difference.after = now[t] ? "reached" : "missed";
    difference.relative = now[t] ? -kNever : kNever;
    all.push_back(std::move(difference));
  }
  return all;
}

// Judges times: exact ranks, an interval of the ratio, and the noise that the repetitions show.

namespace {

// Fisher and Yates.
void shuffle(std::vector<Real>& values, Draws& random) {
  for (std::size_t i = values.size(); i > 1; --i)
    std::swap(values[i - 1], values[static_cast<std::size_t>(random.uniform(0, Real(i)))]);
}

// The median of all differences right − left.
Real shift(const std::vector<Real>& left, const std::vector<Real>& right,
           std::vector<Real>& differences) {
  differences.clear();
  for (const Real a : left)
    for (const Real b : right) differences.push_back(b - a);
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

TimeVerdict measured(const TimedCell& cell, Real noise) {
  return {.key = cell.key,
          .title = cell.title,
          .n_before = cell.before.size(),
          .n_after = cell.after.size(),
          .ratio = ratio_estimate(cell.before, cell.after),
          .p = mann_whitney_p(cell.before, cell.after),
          .noise = noise};
}

// Adds |shift| between the halves of many splits, times √(the sides' variance over the halves').
void add_shifts(const std::vector<Real>& seconds, Real sides, const std::string& key,
                std::vector<Real>& shifts) {
  constexpr std::size_t kSplits = 200;
  constexpr std::size_t kMostUsed = 40;  // repetitions a split: pairs grow by the square
  std::vector<Real> logs, differences;
  for (const Real value : seconds) logs.push_back(std::log(value));
  const std::size_t used = std::min(logs.size(), kMostUsed), half = used / 2;
  if (half == 0) return;
  const Real halves = 1 / Real(half) + 1 / Real(used - half);
  for (std::size_t split = 0; split < kSplits; ++split) {
    Draws random(fnv1a(key), "report", "halves", split);
    shuffle(logs, random);
    const auto middle = logs.begin() + static_cast<std::ptrdiff_t>(half);
    const auto end = logs.begin() + static_cast<std::ptrdiff_t>(used);
    shifts.push_back(std::abs(shift({logs.begin(), middle}, {middle, end}, differences)) *
                     std::sqrt(sides / halves));
  }
}

}  // namespace

Real split_noise(const std::vector<TimedCell>& cells) {
  constexpr Real kWithin = 0.95;
  std::vector<Real> shifts;
  for (const TimedCell& cell : cells) {
    const Real sides = 1 / Real(cell.before.size()) + 1 / Real(cell.after.size());
    add_shifts(cell.before, sides, cell.key, shifts);
    add_shifts(cell.after, sides, cell.key, shifts);
  }
  if (shifts.empty()) return kNever;
  const auto at = shifts.begin() + static_cast<std::ptrdiff_t>(kWithin * Real(shifts.size()));
  std::nth_element(shifts.begin(), at, shifts.end());
  return std::expm1(*at);
}

std::vector<TimeVerdict> judge_times(const std::vector<TimedCell>& cells, Real least_noise) {
  std::vector<TimeVerdict> verdicts;
  std::vector<Real> p;
  const Real noise = std::max(least_noise, split_noise(cells));
  for (const TimedCell& cell : cells) {
    verdicts.push_back(measured(cell, noise));
    p.push_back(verdicts.back().p);
  }
  const std::vector<Real> adjusted = benjamini_hochberg(p);
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    TimeVerdict& verdict = verdicts[i];
    verdict.adjusted = adjusted[i];
    if (verdict.adjusted > kFalseDiscoveries) continue;
    if (verdict.ratio.low > 1 + verdict.noise) verdict.change = 1;
    if (verdict.ratio.high < 1 / (1 + verdict.noise)) verdict.change = -1;
  }
  std::ranges::stable_sort(verdicts, [](const TimeVerdict& a, const TimeVerdict& b) {
    return std::pair(-a.change, -a.ratio.ratio) < std::pair(-b.change, -b.ratio.ratio);
  });
  return verdicts;
}

}  // namespace isoline::reports
