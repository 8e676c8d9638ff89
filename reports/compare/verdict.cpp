// Concludes: worse before not comparable before better; each with its cause in the same sentence.
#include "reports/compare/verdict.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/compare/changes.h"
#include "reports/compare/gate_words.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// "adam in all 26 cells, in sine × adam, seed 0: loss 1e-3 → 2; 3 other optimizers".
std::string cause_in(const std::vector<DifferenceGroup>& groups, Change change) {
  std::vector<const DifferenceGroup*> its;
  for (const DifferenceGroup& group : groups)
    if (group.change == change) its.push_back(&group);
  if (its.empty()) return "";
  const DifferenceGroup& first = *its[0];
  const std::string more =
      its.size() == 1 ? "" : fmt::format("; and {}", counted(its.size() - 1, "other optimizer"));
  return fmt::format("{} in {} cell{}, in {}: {}{}", first.optimizer,
                     share_text(first.cells, first.of), first.of == 1 ? "" : "s", first.worst.title,
                     step_text(first.worst), more);
}

std::string lack_cause(const GateResult& result) {
  if (result.only_before.empty()) return "";
  std::vector<std::string> names;
  for (const OtherTerms& terms : result.otherwise)
    names.push_back(fmt::format("{} with another budget in NEW, {}", terms.cells, terms.what));
  for (const LackGroup& group : result.lacking)
    names.push_back(fmt::format("{} of {}", share_text(group.cells, group.of), group.optimizer));
  return fmt::format("NEW lacks {} of BASE ({})", counted(result.only_before.size(), "cell"),
                     names_text(names));
}

// Where nothing else is worse, or better.
std::string rounding_cause(const GateResult& result, Change change) {
  const Difference* largest = nullptr;
  for (const Difference& difference : result.differences) {
    if (difference.change != change) continue;
    if (!difference.is_rounding) return "";
    if (largest == nullptr) largest = &difference;
  }
  if (largest == nullptr) return "";
  return fmt::format("by rounding alone, most in {}: {}", largest->title, step_text(*largest));
}

std::string time_cause(const std::vector<TimeVerdict>& times, int change, const char* word) {
  const auto count = std::ranges::count(times, change, &TimeVerdict::change);
  if (count == 0) return "";
  const auto first = std::ranges::find(times, change, &TimeVerdict::change);
  return fmt::format("{} {}, {} by {}", counted(static_cast<std::size_t>(count), "cell"), word,
                     first->title, ratio_text(first->ratio));
}

std::string incomparable_cause(const std::vector<Incomparable>& all) {
  const std::string first = all[0].title + ": " + all[0].reason;
  return all.size() == 1 ? first : fmt::format("{} cells, as {}", all.size(), first);
}

std::string settings_cause(const std::vector<std::string>& settings) {
  if (settings.size() <= 1) return joined(settings);
  return fmt::format("{}, and {} of options", settings[0],
                     counted(settings.size() - 1, "other change"));
}

std::string with_causes(const std::string& verdict, std::vector<std::string> causes) {
  std::erase(causes, "");
  return causes.empty() ? verdict : verdict + ": " + joined(causes, "; ");
}

}  // namespace

void conclude(GateResult& result, const GateOptions& options) {
  const auto has = [&](Change change) {
    return std::ranges::any_of(result.differences,
                               [&](const Difference& d) { return d.change == change; });
  };
  const auto settle = [&](ExitCode code, std::string verdict) {
    result.exit_code = code;
    result.verdict = std::move(verdict);
  };
  const std::string lacks = options.is_common_only ? "" : lack_cause(result);
  const std::string slower = time_cause(result.times, 1, "slower");
  const std::string faster = time_cause(result.times, -1, "faster");
  if (has(Change::worse) || !slower.empty() || !lacks.empty())
    settle(kWorse, with_causes("worse", {settings_cause(result.settings), lacks,
                                         cause_in(result.groups, Change::worse),
                                         rounding_cause(result, Change::worse), slower}));
  else if (result.joined == 0)
    settle(kNotComparable, "not comparable: no cell is in both");
  else if (!result.incomparable.empty())
    settle(kNotComparable, with_causes("not comparable in part, nothing worse in the rest",
                                       {incomparable_cause(result.incomparable)}));
  else if (has(Change::better) || !faster.empty())
    settle(kBetterOnly,
           with_causes("better, nothing worse",
                       {settings_cause(result.settings), cause_in(result.groups, Change::better),
                        rounding_cause(result, Change::better), faster}));
  else if (has(Change::changed) || !result.settings.empty())
    settle(kGood,
           with_causes("changed, neither better nor worse", {settings_cause(result.settings)}));
  else
    settle(kGood, "equal");
}

}  // namespace isoline::reports
