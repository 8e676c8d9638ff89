// Differences between the figures of two cells.
#include "reports/compare/differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kRounding = 1e-16;   // of double precision, as a share of the problem's scale
constexpr Real kSummation = 1e-12;  // relative: sums of some thousand numbers in another order

// Not-a-number is no better than infinite.
Real finite_or_never(Real value) { return std::isnan(value) ? kNever : value; }

// As a share of |before|, or of the smallest value that counts, above what rounding explains.
Real least_tolerance(Real before, Real after, Real scale) {
  if (before == after) return 0;
  if (!std::isfinite(before) || !std::isfinite(after)) return kNever;
  const Real size = std::isfinite(scale) ? std::abs(scale) : 0;
  const Real excess = std::abs(after - before) - kRounding * size;
  if (excess <= 0) return 0;
  const Real unit = std::max(std::abs(before), kSmallestShare * size);
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

Change change_from(Real before, Real after) {
  if (before == after) return Change::changed;
  return after > before ? Change::worse : Change::better;
}

Difference difference_of(const ComparedCell& cell, const ComparedFigure& each, Real before,
                         Real after) {
  const bool looks_equal = reached_figure(before) == reached_figure(after);
  const auto text = looks_equal ? exact_figure : reached_figure;
  Difference difference =
      difference_in(cell, change_from(before, after), figure_name(each), text(before), text(after));
  difference.relative = relative_change(before, after);
  difference.is_rounding = least_tolerance(before, after, each.scale) <= kSummation;
  return difference;
}

// For each value that both have: its name; its values before and after.
template <class Visit>
void visit_common_figures(const ComparedCell& a, const ComparedCell& b, Visit visit) {
  const auto place = [](const ComparedFigure& each) { return std::pair(each.quantity, each.rung); };
  std::map<std::pair<Quantity, std::size_t>, const ComparedFigure*> before;
  for (const ComparedFigure& each : a.figures) before[place(each)] = &each;
  for (const ComparedFigure& each : b.figures)
    if (const auto at = before.find(place(each)); at != before.end())
      visit(*at->second, finite_or_never(at->second->value), finite_or_never(each.value));
}

bool has_quantity(const ComparedCell& cell, Quantity quantity) {
  return std::ranges::find(cell.figures, quantity, &ComparedFigure::quantity) != cell.figures.end();
}

std::string privileges_text(const ComparedCell& cell) {
  return cell.privileges.empty() ? "none" : joined(cell.privileges);
}

// Those that no size has. A status that broke off explains what is lacking.
std::vector<Difference> differences_of_kind(const ComparedCell& a, const ComparedCell& b) {
  std::vector<Difference> found;
  for (const auto& [quantity, what] :
       {std::pair(Quantity::x_error, "error in x"), {Quantity::work, "work to the targets"}})
    if (has_quantity(a, quantity) && !has_quantity(b, quantity) && a.status == b.status)
      found.push_back(difference_in(a, Change::worse, what, "known", "gone"));
  if (!a.criterion || !b.criterion || a.privileges == b.privileges) return found;
  const Change change = a.privileges.size() < b.privileges.size() ? Change::worse : Change::better;
  found.push_back(
      difference_in(a, change, "extra information", privileges_text(a), privileges_text(b)));
  return found;
}

}  // namespace

Difference difference_in(const ComparedCell& cell, Change change, const std::string& what,
                         const std::string& before, const std::string& after) {
  return {.change = change,
          .key = cell.key,
          .title = cell.title,
          .problem = cell.problem.name,
          .optimizer = cell.optimizer.name,
          .what = what,
          .before = before,
          .after = after,
          .relative = change == Change::changed ? 0
                      : change == Change::worse ? kNever
                                                : -kNever,
          .note = "",
          .cause = ""};
}

Difference status_difference(const ComparedCell& a, const ComparedCell& b) {
  return difference_in(a, change_from(badness_of(a.status), badness_of(b.status)), "status",
                       std::string(name_of(a.status)), std::string(name_of(b.status)));
}

std::string criterion_change_text(const ComparedCell& before, const ComparedCell& after,
                                  const std::optional<Real>& tolerance) {
  if (!before.criterion || !after.criterion) return "";
  const Criterion &a = *before.criterion, &b = *after.criterion;
  std::vector<std::string> changes;
  const auto add = [&](const char* name, const std::optional<Real>& old,
                       const std::optional<Real>& now, Real scale) {
    if (old == now || (old && now && agree(*old, *now, scale, tolerance))) return;
    const auto text = [](const auto& value) { return value ? exact_figure(*value) : "unknown"; };
    changes.push_back(fmt::format("{} {} → {}", name, text(old), text(now)));
  };
  const Real x_scale = a.x_scale.value_or(0);
  add("f_L", a.minimum, b.minimum, a.scale.value_or(0));
  add("scale", a.scale, b.scale, 0);
  add("norm of x*", a.x_scale, b.x_scale, 0);
  add("floor of the error in x", a.x_floor, b.x_floor, x_scale);
  if (a.aim != b.aim)
    changes.push_back(fmt::format("success criterion {} → {}", name_of(a.aim), name_of(b.aim)));
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (a.prices[kind] != b.prices[kind])
      changes.push_back(fmt::format("nominal cost of {} {} → {}", kOracleNames[kind],
                                    a.prices[kind], b.prices[kind]));
  return joined(changes);
}

Real movement(const ComparedCell& a, const ComparedCell& b) {
  if (a.status != b.status) return kNever;
  Real most = 0;
  visit_common_figures(a, b, [&](const ComparedFigure& each, Real before, Real after) {
    most = std::max(most, least_tolerance(before, after, each.scale));
  });
  return most;
}

std::vector<Difference> figure_differences(const ComparedCell& a, const ComparedCell& b,
                                           const std::optional<Real>& tolerance) {
  using Kind = std::pair<Quantity, Change>;            // losses share a line
  std::map<Kind, std::pair<Difference, int>> largest;  // with how many more there are
  visit_common_figures(a, b, [&](const ComparedFigure& each, Real before, Real after) {
    if (agree(before, after, each.scale, tolerance)) return;
    Difference difference = difference_of(a, each, before, after);
    const bool is_loss = each.quantity == Quantity::best_loss || each.quantity == Quantity::path;
    const Kind kind(is_loss ? Quantity::loss : each.quantity, difference.change);
    const auto [at, is_first] = largest.try_emplace(kind, difference, 0);
    if (is_first) return;
    auto& [kept, more] = at->second;
    ++more;
    if (std::abs(difference.relative) > std::abs(kept.relative)) kept = std::move(difference);
  });
  std::vector<Difference> out = differences_of_kind(a, b);
  for (auto& [kind, kept] : largest) {
    auto& [difference, more] = kept;
    if (more > 0) difference.note = fmt::format("and {} more like it", more);
    out.push_back(std::move(difference));
  }
  return out;
}

namespace {

// Another processor rounds in every operation, a perturbed start once: cells that moved by nearly
// the tolerance when perturbed move beyond it elsewhere.
constexpr Real kMargin = 0.1;

// In the sense of the aim that BASE knows of.
std::array<bool, kTolerances.size()> reached_by(const ComparedCell& cell, Aim aim) {
  std::array<bool, kTolerances.size()> reached{};
  for (std::size_t t = 0; t < reached.size(); ++t)
    reached[t] = work_to(cell, aim, kTolerances[t].rung) < kNever;
  return reached;
}

std::optional<Difference> coarse_status_difference(const ComparedCell& a, const ComparedCell& b) {
  std::set<std::string> seen;
  int least = badness_of(a.status), most = least;
  std::vector<Status> statuses = a.perturbed->statuses;
  statuses.push_back(a.status);
  if (std::ranges::find(statuses, b.status) != statuses.end()) return std::nullopt;
  for (const Status status : statuses) {
    seen.emplace(name_of(status));
    least = std::min(least, badness_of(status));
    most = std::max(most, badness_of(status));
  }
  const int now = badness_of(b.status);
  const Change change = now > most ? Change::worse : now < least ? Change::better : Change::changed;
  return difference_in(a, change, "status", joined({seen.begin(), seen.end()}, " or "),
                       std::string(name_of(b.status)));
}

}  // namespace

Perturbed perturbed_of(const ComparedCell& unperturbed,
                       const std::vector<ComparedCell>& perturbed) {
  Perturbed found;
  for (const ComparedCell& cell : perturbed) {
    found.moved = std::max(found.moved, movement(unperturbed, cell));
    found.statuses.push_back(cell.status);
    const auto reached = reached_by(cell, unperturbed.aim);
    for (std::size_t t = 0; t < reached.size(); ++t) found.reached[t] += reached[t];
  }
  return found;
}

bool is_chaotic(const ComparedCell& cell, const std::optional<Real>& tolerance) {
  return tolerance && cell.perturbed && cell.perturbed->moved > kMargin * *tolerance;
}

std::vector<Difference> coarse_differences(const ComparedCell& a, const ComparedCell& b) {
  std::vector<Difference> all;
  if (auto difference = coarse_status_difference(a, b)) all.push_back(std::move(*difference));
  const auto then = reached_by(a, a.aim), now = reached_by(b, a.aim);
  for (std::size_t t = 0; t < now.size(); ++t) {
    const std::size_t reached = a.perturbed->reached[t] + then[t];
    const std::size_t runs = a.perturbed->statuses.size() + 1;
    if (now[t] ? reached > 0 : reached < runs) continue;
    const std::string what = fmt::format("target {}", kTolerances[t].name);
    all.push_back(now[t] ? difference_in(a, Change::better, what, "missed", "reached")
                         : difference_in(a, Change::worse, what, "reached", "missed"));
  }
  for (Difference& one : all) one.note = "chaotic: compared by status and coarse targets";
  return all;
}

}  // namespace isoline::reports
