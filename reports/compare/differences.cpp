// Holds the figures of two subjects to each other.
#include "reports/compare/differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

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

}  // namespace isoline::reports
