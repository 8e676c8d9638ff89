// Pairs cells of BASE and NEW, and finds the differences of their statuses, values, options and
// builds.
#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "core/spec.h"
#include "reports/compare/gate.h"
#include "reports/sections/words.h"

namespace isoline::reports {

// The star is the only wildcard: brackets belong to specifications.
bool matches(const std::string& pattern, const std::string& text) {
  std::string escaped;
  for (const char letter : pattern) {
    if (letter != '*') escaped += '\\';
    escaped += letter;
  }
  return ::fnmatch(escaped.c_str(), text.c_str(), 0) == 0;
}

bool is_of(const AllowedCells& entry, const ComparedCell& cell) {
  const auto names = [](const std::string& pattern, const Component& component) {
    return matches(pattern, component.name) || matches(pattern, component.asked) ||
           matches(pattern, component.spec);
  };
  return names(entry.problem, *cell.problem) && names(entry.optimizer, *cell.optimizer);
}

AllowedList allowed_from_json(const Json& json) {
  try {
    require(json.at("schema") == kAllowedSchema,
            [&] { return fmt::format("the schema is not {}", kAllowedSchema); });
    AllowedList list;
    for (const Json& cells : json.at("cells")) {
      require(cells.contains("problem") || cells.contains("optimizer"),
              "an entry of the allowed cells must contain a problem or an optimizer");
      list.push_back({.problem = cells.value("problem", std::string("*")),
                      .optimizer = cells.value("optimizer", std::string("*")),
                      .reason = cells.at("reason").get<std::string>(),
                      .is_of_criterion = cells.value("allows", std::string()) == "criterion"});
      require(!list.back().reason.empty(), "an entry of the allowed cells must give a reason");
    }
    return list;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("not a valid {}: {}", kAllowedSchema, reason_of(error)));
  }
}

AllowedList read_allowed(const std::filesystem::path& file) {
  return allowed_from_json(read_json(file));
}

Pairs paired(const std::vector<ComparedCell>& before, const std::vector<ComparedCell>& after) {
  constexpr std::string (*kIdentities[])(const ComparedCell&) = {
      [](const ComparedCell& cell) { return cell.key; },
      [](const ComparedCell& cell) {
        return fmt::format("{} × {}, seed {}{}", cell.problem->asked, cell.optimizer->asked,
                           cell.seed, cell.terms);
      },
      [](const ComparedCell& cell) {
        return fmt::format("{} × {}, seed {}{}", cell.problem->spec, cell.optimizer->spec,
                           cell.seed, cell.terms);
      }};
  std::vector<const ComparedCell*> answer(before.size()), unpaired;
  for (const ComparedCell& cell : after) unpaired.push_back(&cell);
  for (const auto& identity : kIdentities) {
    std::map<std::string, std::array<std::vector<std::size_t>, 2>> sides;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (answer[i] == nullptr) sides[identity(before[i])][0].push_back(i);
    for (std::size_t i = 0; i < after.size(); ++i)
      if (unpaired[i] != nullptr) sides[identity(after[i])][1].push_back(i);
    for (const auto& [name, side] : sides)
      if (!name.empty() && side[0].size() == 1 && side[1].size() == 1)
        std::swap(answer[side[0][0]], unpaired[side[1][0]]);
  }
  Pairs pairs{.only_after = unpaired};
  std::erase(pairs.only_after, nullptr);
  for (std::size_t i = 0; i < before.size(); ++i)
    if (answer[i] != nullptr)
      pairs.both.emplace_back(&before[i], answer[i]);
    else
      pairs.only_before.push_back(&before[i]);
  return pairs;
}

// Two equally bad values may still differ: this is a change without a verdict.
int badness_of(Status status) {
  if (status >= Status::converged && status <= Status::discrepancy) return 0;  // target, too
  if (status == Status::budget || status == Status::stalled) return 1;
  return status == Status::diverged ? 2 : 3;
}

Difference difference_in(const ComparedCell& cell, Change change, const std::string& what,
                         const std::string& before, const std::string& after) {
  return {.change = change,
          .key = cell.key,
          .title = cell.title,
          .problem = cell.problem->name,
          .optimizer = cell.optimizer->name,
          .what = what,
          .before = before,
          .after = after,
          .relative = change == Change::changed ? 0
                      : change == Change::worse ? kNever
                                                : -kNever};
}

namespace {

constexpr Real kRounding = 1e-16;  // of double precision, as a share of the problem's scale

// Relative to |before|, or to the smallest value that counts, after subtraction of the rounding.
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
  return tolerance ? least_tolerance(before, after, scale) <= *tolerance : before == after;
}

Change change_from(Real before, Real after) {
  if (before == after) return Change::changed;
  return after > before ? Change::worse : Change::better;
}

// Where rounding, and what is too small to tell, are measured from.
Real scale_of(const ComparedCell& cell, std::size_t figure) {
  if (figure == kPath) return cell.figures[kPath] / kSmallestShare;
  return figure < kPath ? cell.scale : figure == kXError ? cell.x_scale : 0;
}

Difference difference_of(const ComparedCell& cell, std::size_t figure, Real before, Real after) {
  const bool looks_equal = reached_figure(before) == reached_figure(after);
  const auto text = looks_equal ? exact_figure : reached_figure;
  Difference difference = difference_in(cell, change_from(before, after), figure_name(figure),
                                        text(before), text(after));
  if (std::isfinite(before) && std::isfinite(after) && before != 0)
    difference.relative = (after - before) / std::abs(before);
  return difference;
}

// Differences without a size. If a status broke off, it explains the missing values.
Differences differences_of_kind(const ComparedCell& a, const ComparedCell& b) {
  Differences found;
  for (const auto& [figure, what] :
       {std::pair(kXError, "error in x"), {work_at(Aim::loss, 0), "work to reach the targets"}})
    if (a.has(figure) && !b.has(figure) && a.status == b.status)
      found.push_back(difference_in(a, Change::worse, what, "known", "gone"));
  if (b.verdicts < a.verdicts && !a.file.empty() && a.status == b.status)
    found.push_back(difference_in(a, Change::worse, "verdicts on the last point",
                                  std::to_string(a.verdicts), std::to_string(b.verdicts)));
  if (a.privileges == b.privileges) return found;
  const auto text = [](const ComparedCell& cell) {
    return cell.privileges.empty() ? "none" : joined(cell.privileges);
  };
  // A method sees no less without a change of its source.
  const bool is_worse = a.privileges.size() < b.privileges.size() || a.build == b.build;
  const Change change = is_worse ? Change::worse : Change::better;
  found.push_back(difference_in(a, change, "extra information", text(a), text(b)));
  return found;
}

// Another processor rounds in every operation, but a perturbed start differs only once. Cells that
// changed by almost the tolerance after a perturbation change by more on another processor.
constexpr Real kMargin = 0.1;

// By the success criterion of BASE.
bool has_reached(const ComparedCell& cell, Aim aim, std::size_t tolerance) {
  const std::size_t figure = work_at(aim, tolerance);
  return cell.has(figure) && cell.figures[figure] < kNever;
}

void add_coarse_status(const ComparedCell& a, const ComparedCell& b, Differences& all) {
  std::vector<Status> statuses = a.perturbed->statuses;
  statuses.push_back(a.status);
  if (std::ranges::find(statuses, b.status) != statuses.end()) return;
  std::set<std::string> seen;
  for (const Status status : statuses) seen.emplace(name_of(status));
  const auto [least, most] = std::ranges::minmax(statuses, {}, badness_of);
  const int now = badness_of(b.status);
  const Change change = now > badness_of(most)    ? Change::worse
                        : now < badness_of(least) ? Change::better
                                                  : Change::changed;
  all.push_back(difference_in(a, change, "status", joined({seen.begin(), seen.end()}, " or "),
                              std::string(name_of(b.status))));
}

std::string value_text(const OptionValue& value) {
  const Real* const number = std::get_if<Real>(&value);
  return number == nullptr ? option_text(value) : exact_figure(*number);
}

bool is_set_in(const std::string& spec, const std::string& option) {
  const auto given = parse_spec(spec).options;
  return std::ranges::any_of(given, [&](const auto& set) { return set.first == option; });
}

// Paired by what was asked, two differ in an option only by a default or by a table of rates. An
// empty option equals one that did not exist yet.
void add_changes(const Component& a, const Component& b, std::set<std::string>& changes) {
  std::set<std::string> options;
  for (const Component* side : {&a, &b})
    for (const NamedOption& each : side->options) options.insert(each.name);
  for (const std::string& option : options) {
    const OptionValue *const old = a.options.find(option), *const now = b.options.find(option);
    if (old != nullptr && now != nullptr ? *old == *now : option_text(*(old ? old : now)).empty())
      continue;
    const std::string change =
        old == nullptr ? fmt::format("new option {} {}", option, value_text(*now))
        : now == nullptr
            ? fmt::format("option {} was removed; it was {}", option, value_text(*old))
            : fmt::format(
                  "{} {} {} → {}",
                  is_set_in(a.spec, option) && is_set_in(b.spec, option) ? "tabled" : "default of",
                  option, value_text(*old), value_text(*now));
    changes.insert(a.name + ": " + change);
  }
}

}  // namespace

Difference status_difference(const ComparedCell& a, const ComparedCell& b) {
  return difference_in(a, change_from(badness_of(a.status), badness_of(b.status)), "status",
                       std::string(name_of(a.status)), std::string(name_of(b.status)));
}

std::string criterion_change_text(const ComparedCell& before, const ComparedCell& after,
                                  const std::optional<Real>& tolerance) {
  const Criterion &a = before.criterion, &b = after.criterion;
  std::vector<std::string> changes;
  const auto add = [&](const char* name, const std::optional<Real>& old,
                       const std::optional<Real>& now, Real scale) {
    if (old == now || (old && now && agree(*old, *now, scale, tolerance))) return;
    const auto text = [](const auto& value) { return value ? exact_figure(*value) : "unknown"; };
    changes.push_back(fmt::format("{} {} → {}", name, text(old), text(now)));
  };
  add("f_L", a.minimum, b.minimum, a.scale.value_or(0));
  add("scale", a.scale, b.scale, 0);
  add("norm of x*", a.x_scale, b.x_scale, 0);
  add("floor of the error in x", a.x_floor, b.x_floor, a.x_scale.value_or(0));
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
  for (std::size_t i = 0; i < kFigures; ++i)
    if (a.has(i) && b.has(i))
      most = std::max(most, least_tolerance(a.figures[i], b.figures[i], scale_of(a, i)));
  return most;
}

Differences figure_differences(const ComparedCell& a, const ComparedCell& b,
                               const std::optional<Real>& tolerance) {
  Differences out = differences_of_kind(a, b);
  std::map<std::pair<const char*, Change>, std::pair<std::size_t, int>> largest;  // and count
  for (const FigureKind& kind : kFigureKinds)
    for (std::size_t i = kind.first; i < kind.first + kind.count; ++i) {
      if (!a.has(i) || !b.has(i) || agree(a.figures[i], b.figures[i], scale_of(a, i), tolerance))
        continue;
      Difference difference = difference_of(a, i, a.figures[i], b.figures[i]);
      const char* const key = i <= kPath ? kFigureKinds[kLoss].key : kind.key;  // losses share one
      const auto [at, is_first] =
          largest.try_emplace({key, difference.change}, std::pair(out.size(), 0));
      if (is_first) {
        out.push_back(std::move(difference));
        continue;
      }
      auto& [place, more] = at->second;
      if (std::abs(difference.relative) > std::abs(out[place].relative))
        out[place] = std::move(difference);
      out[place].note = fmt::format("and {} more like it", ++more);
    }
  return out;
}

Perturbed perturbed_of(const ComparedCell& unperturbed,
                       const std::vector<ComparedCell>& perturbed) {
  Perturbed found;
  for (const ComparedCell& cell : perturbed) {
    found.moved = std::max(found.moved, movement(unperturbed, cell));
    found.statuses.push_back(cell.status);
    for (std::size_t t = 0; t < kTolerances.size(); ++t)
      found.reached[t] += has_reached(cell, unperturbed.criterion.aim, t);
  }
  return found;
}

bool is_chaotic(const ComparedCell& cell, const std::optional<Real>& tolerance) {
  return tolerance && cell.perturbed && cell.perturbed->moved > kMargin * *tolerance;
}

Differences coarse_differences(const ComparedCell& a, const ComparedCell& b) {
  Differences all;
  add_coarse_status(a, b, all);
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    const bool is_reached = has_reached(b, a.criterion.aim, t);
    const std::size_t reached = a.perturbed->reached[t] + has_reached(a, a.criterion.aim, t);
    if (is_reached ? reached > 0 : reached <= a.perturbed->statuses.size()) continue;
    all.push_back(difference_in(a, is_reached ? Change::better : Change::worse,
                                fmt::format("target {}", kTolerances[t].name),
                                is_reached ? "missed" : "reached",
                                is_reached ? "reached" : "missed"));
  }
  for (Difference& one : all) one.note = "chaotic: compared by status and targets 1e-1, 1e-3, 1e-6";
  return all;
}

std::set<std::string> changed_options(const ComparedCell& before, const ComparedCell& after) {
  std::set<std::string> changes;
  if (before.problem != after.problem) add_changes(*before.problem, *after.problem, changes);
  if (before.optimizer != after.optimizer)
    add_changes(*before.optimizer, *after.optimizer, changes);
  return changes;
}

std::vector<std::string> changed_parts(const ComparedCell& before, const ComparedCell& after) {
  if (before.build == after.build) return {};
  std::vector<std::string> changes;
  for (const auto& [part, text] : std::vector<std::pair<std::string, const char*>>{
           {"platform", "a change of the platform (compiler, flags, libraries or kernel)"},
           {"harness", "a change of the harness (core, meter or run loop)"},
           {"problem", "a change of the problem's source"},
           {"network", "a change of the network's source"},
           {"optimizer", "a change of the optimizer's source"},
           {"best", "a change of the lowest known loss"}}) {  // which may have become known
    const auto old = before.parts->find(part), now = after.parts->find(part);
    const bool was = old != before.parts->end(), is = now != after.parts->end();
    if (was && is ? old->second != now->second : was != is && part == "best")
      changes.emplace_back(text);
  }
  if (changes.empty()) changes.emplace_back("a change of the build");
  return changes;
}

}  // namespace isoline::reports
