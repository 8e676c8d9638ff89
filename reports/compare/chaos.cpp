// Judges chaotic results by their status and their coarse targets.
#include "reports/compare/chaos.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "reports/sections/words.h"

namespace isoline::reports {
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

}  // namespace isoline::reports
