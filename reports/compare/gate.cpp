// Pairs two sets of subjects, holds their figures to each other, judges their times, and concludes.
#include "reports/compare/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/errors.h"
#include "reports/compare/changes.h"
#include "reports/compare/chaos.h"
#include "reports/compare/pairing.h"
#include "reports/compare/verdict.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// Why figures of the two cannot be held to each other; empty where they can.
std::string why_incomparable(const Subject& a, const Subject& b, const GateOptions& options) {
  for (const Subject* side : {&a, &b})
    if (!side->doubt.empty())
      return fmt::format("{} cannot be trusted: {}", side == &a ? "BASE" : "NEW", side->doubt);
  if (a.is_cut || b.is_cut)
    return fmt::format("a clock or a kill ended it in {} ({})", b.is_cut ? "NEW" : "BASE",
                       b.is_cut ? b.state : a.state);
  if (a.asked != b.asked) return "other seeds, budgets or options were asked for";
  if (options.tolerance || (a.builds == b.builds && a.builds.size() == 1)) return "";
  if (a.builds.empty() && b.builds.empty()) return "";  // nothing has run on either side
  return "another build or instruction set; give --tolerance to compare their figures";
}

// "curve", "message, claimed": what of the records differs where all figures agree.
Difference silent_difference(const Subject& a, const Subject& b) {
  Difference difference{.change = Change::changed,
                        .key = a.key,
                        .title = a.title,
                        .optimizer = a.optimizer.name,
                        .what = "trace",
                        .before = a.trace,
                        .after = b.trace,
                        .note = "the path differs, all compared figures agree"};
  if (a.trace != b.trace) return difference;
  std::map<std::string_view, std::array<std::uint64_t, 2>> members;  // of none 0
  for (const auto& [name, digest] : a.members) members[*name][0] = digest;
  for (const auto& [name, digest] : b.members) members[*name][1] = digest;
  std::vector<std::string> names;
  for (const auto& [name, digests] : members)
    if (digests[0] != digests[1]) names.emplace_back(name);
  difference.what = names.empty() || a.members.empty() ? "record" : joined(names);
  difference.before = a.rest;
  difference.after = b.rest;
  difference.note = "its path and all compared figures agree";
  return difference;
}

class Gate {
 public:
  explicit Gate(const GateOptions& options) : options_(options) {}

  GateResult run(const std::vector<Subject>& before, const std::vector<Subject>& after) {
    const Pairs pairs = paired(before, after);
    result_.builds = changed_builds(pairs);
    result_.settings = changed_settings(pairs);
    for (const auto& [a, b] : pairs.both) join(*a, *b);
    miss(pairs.only_before, before);
    for (const Subject* subject : pairs.only_after) result_.only_after.push_back(subject->title);
    result_.added = grouped(pairs.only_after, after);
    choose_timed();
    result_.times = judge_times(timed_, options_.least_noise);
    sort_differences();
    result_.groups = grouped(result_.differences, result_.by_method);
    add_remarks();
    conclude(result_, options_);
    return result_;
  }

 private:
  void join(const Subject& a, const Subject& b) {
    ++result_.joined;
    ++result_.by_method[a.optimizer.name];
    offer_times(a, b);
    const std::string reason = why_incomparable(a, b, options_);
    if (reason.empty()) return judge(a, b);
    const bool tells_status = a.is_cut || b.is_cut ? a.badness != b.badness : a.lost != b.lost;
    if (tells_status && a.doubt.empty() && b.doubt.empty())
      result_.differences.push_back(state_difference(a, b));
    else
      result_.incomparable.push_back({a.title, reason});
  }

  std::vector<Difference> differences_of(const Subject& a, const Subject& b) const {
    std::vector<Difference> found = quantity_differences(a, b, options_.tolerance);
    if (a.state != b.state) found.insert(found.begin(), state_difference(a, b));
    const bool is_silent = found.empty() && !options_.tolerance;
    if (is_silent && (a.trace != b.trace || a.rest != b.rest))
      found.push_back(silent_difference(a, b));
    return found;
  }

  void judge(const Subject& a, const Subject& b) {
    std::vector<Difference> found = differences_of(a, b);
    const bool is_coarse = !found.empty() && is_chaotic(a, options_.tolerance);
    if (is_coarse) found = coarse_differences(a, b);
    result_.equal += found.empty() && !is_coarse;
    result_.chaotic += is_coarse;
    for (Difference& difference : found) result_.differences.push_back(std::move(difference));
  }

  void miss(const std::vector<const Subject*>& lacking, const std::vector<Subject>& before) {
    std::vector<bool> is_used(options_.allowed.size());
    std::vector<const Subject*> unexpected;
    for (const Subject* subject : lacking) {
      const auto entry = entry_for(options_.allowed, *subject);
      if (entry == options_.allowed.end()) {
        unexpected.push_back(subject);
        result_.only_before.push_back(subject->title);
        continue;
      }
      result_.allowed.push_back({subject->title, entry->reason});
      is_used[static_cast<std::size_t>(entry - options_.allowed.begin())] = true;
    }
    result_.lacking = grouped(unexpected, before);
    for (std::size_t i = 0; i < is_used.size(); ++i)
      if (!is_used[i])
        result_.remarks.push_back(fmt::format(
            "the list of allowed cells names {} × {}, which NEW does not lack: remove the entry",
            options_.allowed[i].problem, options_.allowed[i].optimizer));
  }

  void offer_times(const Subject& a, const Subject& b) {
    senseless_ += a.senseless_times + b.senseless_times;
    const bool is_listed = std::ranges::any_of(
        options_.timed, [&](const std::string& start) { return a.key.starts_with(start); });
    if (!options_.timed.empty() && !is_listed) return;
    if (std::min(a.seconds.size(), b.seconds.size()) < kLeastRepetitions) {
      too_few_ += !a.seconds.empty() && !b.seconds.empty();
    } else if (a.processor != b.processor) {
      ++other_processors_;
    } else {
      timed_.push_back({a.key, a.title, a.seconds, b.seconds});
    }
  }

  // The slowest of BASE, which say most and whose choice knows nothing of what changed.
  void choose_timed() {
    if (timed_.size() <= kMostTimed) return;
    require(options_.timed.empty(), [&] {
      return fmt::format("time is judged on at most {} cells, {} are listed", kMostTimed,
                         timed_.size());
    });
    skipped_ = timed_.size() - kMostTimed;
    std::ranges::stable_sort(timed_, std::greater(),
                             [](const TimedCell& cell) { return median_of(cell.before); });
    timed_.resize(kMostTimed);
  }

  void sort_differences() {
    std::ranges::stable_sort(result_.differences, [](const Difference& a, const Difference& b) {
      const auto rank = [](const Difference& d) {
        return std::tuple(d.change == Change::changed, -d.relative, d.what != "status",
                          std::string_view(d.title));
      };
      return rank(a) < rank(b);
    });
  }

  void remark(std::size_t number, const std::string& text) {
    if (number > 0) result_.remarks.push_back(fmt::format("{} {}", number, text));
  }

  void add_remarks() {
    std::vector<std::string> targets;
    for (const Tolerance& tolerance : kTolerances) targets.emplace_back(tolerance.name);
    remark(
        result_.chaotic,
        fmt::format("chaotic cells are judged by their status and by which of the targets {} they "
                    "reach: their figures moved by more than a tenth of the tolerance when their "
                    "start was perturbed in the last bit",
                    joined(targets)));
    remark(too_few_, fmt::format("cells have too few repetitions for a verdict on time: {} a side "
                                 "are needed (run --repeat {} --exclusive)",
                                 kLeastRepetitions, kLeastRepetitions));
    remark(senseless_, "timings are no positive finite numbers and are left out");
    remark(other_processors_, "cells were timed on another processor: times are not comparable");
    remark(skipped_, fmt::format("more cells have repetitions enough; time is judged on the {} "
                                 "slowest (--time-cells lists others)",
                                 kMostTimed));
  }

  const GateOptions& options_;
  std::vector<TimedCell> timed_;
  std::size_t too_few_ = 0, other_processors_ = 0, skipped_ = 0, senseless_ = 0;
  GateResult result_;
};

}  // namespace

GateResult compare_subjects(const std::vector<Subject>& before, const std::vector<Subject>& after,
                            const GateOptions& options) {
  return Gate(options).run(before, after);
}

}  // namespace isoline::reports
