// Joins two sets of subjects, holds their figures to each other, judges their times, and concludes.
#include "reports/compare/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/errors.h"
#include "reports/compare/chaos.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// "1e-1, 1e-3, 1e-6".
std::string target_names() {
  std::vector<std::string> names;
  for (const Tolerance& tolerance : kTolerances) names.emplace_back(tolerance.name);
  return joined(names);
}

// Why figures of the two cannot be held to each other; empty where they can.
std::string why_incomparable(const Subject& a, const Subject& b, const GateOptions& options) {
  if (a.asked != b.asked) return "other seeds, budgets or options were asked for";
  if (options.tolerance || (a.builds == b.builds && a.builds.size() == 1)) return "";
  if (a.builds.empty() && b.builds.empty()) return "";  // nothing has run on either side
  return "another build or instruction set; give --tolerance to compare their figures";
}

class Gate {
 public:
  explicit Gate(const GateOptions& options) : options_(options) {}

  GateResult run(const std::vector<Subject>& before, const std::vector<Subject>& after) {
    std::map<std::string, const Subject*> others;
    for (const Subject& subject : after) others[subject.key] = &subject;
    for (const Subject& subject : before) {
      const auto other = others.find(subject.key);
      if (other == others.end()) {
        result_.only_before.push_back(subject.title);
        continue;
      }
      join(subject, *other->second);
      others.erase(other);
    }
    for (const Subject& subject : after)
      if (others.contains(subject.key)) result_.only_after.push_back(subject.title);
    choose_timed();
    result_.times = judge_times(timed_, options_.least_noise);
    sort_differences();
    conclude();
    return result_;
  }

 private:
  void join(const Subject& a, const Subject& b) {
    ++result_.joined;
    offer_times(a, b);
    if (a.is_nondeterministic || b.is_nondeterministic) {
      ++cut_;
      if (a.lost != b.lost) result_.differences.push_back(state_difference(a, b));
      return;
    }
    const std::string reason = why_incomparable(a, b, options_);
    if (!reason.empty()) {
      if (a.lost != b.lost)
        result_.differences.push_back(state_difference(a, b));
      else
        result_.incomparable.push_back({a.title, reason});
      return;
    }
    judge(a, b);
  }

  std::vector<Difference> differences_of(const Subject& a, const Subject& b) const {
    std::vector<Difference> found = quantity_differences(a, b, options_.tolerance);
    if (a.state != b.state) found.insert(found.begin(), state_difference(a, b));
    if (found.empty() && !options_.tolerance && a.trace != b.trace)
      found.push_back({.key = a.key,
                       .title = a.title,
                       .what = "trace",
                       .before = a.trace,
                       .after = b.trace,
                       .note = "the path differs, all compared figures agree"});
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

  void offer_times(const Subject& a, const Subject& b) {
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

  std::size_t count(Change change) const {
    return static_cast<std::size_t>(
        std::ranges::count(result_.differences, change, &Difference::change));
  }

  void remark(std::size_t number, const std::string& text) {
    if (number > 0) result_.remarks.push_back(fmt::format("{} {}", number, text));
  }

  void conclude() {
    remark(
        result_.chaotic,
        fmt::format("chaotic cells are judged by their status and by which of the targets {} they "
                    "reach: their figures moved by more than the tolerance when their start was "
                    "perturbed in the last bit",
                    target_names()));
    remark(cut_, "cells ended by a clock or a kill: only their status is compared");
    remark(too_few_, fmt::format("cells have too few repetitions for a verdict on time: {} a side "
                                 "are needed (run --repeat {} --exclusive)",
                                 kLeastRepetitions, kLeastRepetitions));
    remark(other_processors_, "cells were timed on another processor: times are not comparable");
    remark(skipped_, fmt::format("more cells have repetitions enough; time is judged on the {} "
                                 "slowest (--time-cells lists others)",
                                 kMostTimed));
    const auto is_slower = [](const TimeVerdict& t) { return t.change > 0; };
    const auto is_faster = [](const TimeVerdict& t) { return t.change < 0; };
    const bool is_part_unseen = !result_.incomparable.empty() || result_.joined == 0 ||
                                (!options_.is_common_only && !result_.only_before.empty());
    if (count(Change::worse) > 0 || std::ranges::any_of(result_.times, is_slower))
      settle(2, "worse");
    else if (is_part_unseen)
      settle(4, result_.joined == 0 ? "not comparable: no cell is in both"
                                    : "not comparable in part, nothing worse in the rest");
    else if (count(Change::better) > 0 || std::ranges::any_of(result_.times, is_faster))
      settle(3, "better, nothing worse");
    else
      settle(0, count(Change::changed) > 0 ? "changed, neither better nor worse" : "equal");
  }

  void settle(int exit_code, const std::string& verdict) {
    result_.exit_code = exit_code;
    result_.verdict = verdict;
  }

  const GateOptions& options_;
  std::vector<TimedCell> timed_;
  std::size_t cut_ = 0, too_few_ = 0, other_processors_ = 0, skipped_ = 0;
  GateResult result_;
};

}  // namespace

GateResult compare_subjects(const std::vector<Subject>& before, const std::vector<Subject>& after,
                            const GateOptions& options) {
  return Gate(options).run(before, after);
}

}  // namespace isoline::reports
