// Pairs two sets of subjects, holds their figures to each other, judges their times, and concludes.
#include "reports/compare/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "reports/compare/baseline.h"
#include "reports/compare/differences.h"
#include "reports/compare/pairing.h"
#include "reports/compare/subject.h"
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
  if (a.asked != b.asked) return "its seeds, budget or options are others";
  if (options.tolerance || (a.builds == b.builds && a.builds.size() == 1)) return "";
  if (a.builds.empty() && b.builds.empty()) return "";  // nothing has run on either side
  return "another build or instruction set; give --tolerance to compare their figures";
}

// "curve", "message, claimed": what of the records differs where all figures agree.
Difference silent_difference(const Subject& a, const Subject& b) {
  Difference difference{.change = Change::changed,
                        .key = a.key,
                        .title = a.title,
                        .problem = a.problem.name,
                        .optimizer = a.optimizer.name,
                        .what = "trace",
                        .before = a.trace,
                        .after = b.trace,
                        .note = "the path differs, all compared figures agree",
                        .cause = ""};
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

// "all 4 of adam, 7 of 10 of gd".
std::string lack_text(const std::vector<const Subject*>& lacking, const std::vector<Subject>& all) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> counts;  // lacking, of all
  for (const Subject* subject : lacking) ++counts[subject->optimizer.name].first;
  for (const Subject& subject : all)
    if (const auto at = counts.find(subject.optimizer.name); at != counts.end())
      ++at->second.second;
  std::vector<std::string> names;
  for (const auto& [name, count] : counts)
    names.push_back(count.first == count.second
                        ? fmt::format("all {} of {}", count.second, name)
                        : fmt::format("{} of {} of {}", count.first, count.second, name));
  return names_text(names);
}

class Gate {
 public:
  explicit Gate(const GateOptions& options) : options_(options) {}

  GateResult run(const std::vector<Subject>& before, const std::vector<Subject>& after) {
    Pairs pairs = paired(before, after);
    result_.builds = changed_builds(pairs);
    result_.settings = changed_settings(pairs);
    for (const auto& [a, b] : pairs.both) join(*a, *b);
    miss(pairs, before);
    choose_timed();
    result_.times = judge_times(timed_, options_.least_noise);
    sort_differences();
    result_.causes = caused(result_.differences, result_.incomparable);
    add_remarks();
    conclude(result_, options_);
    return result_;
  }

 private:
  void join(const Subject& a, const Subject& b) {
    ++result_.joined;
    offer_times(a, b);
    const std::string reason = why_incomparable(a, b, options_);
    if (reason.empty()) return judge(a, b);
    const bool tells_status = a.is_cut || b.is_cut ? a.badness != b.badness : a.lost != b.lost;
    if (tells_status && a.doubt.empty() && b.doubt.empty())
      keep({state_difference(a, b)}, a, b);
    else
      result_.incomparable.push_back({a.title, reason, a.key, a.problem.name, a.optimizer.name});
  }

  void keep(std::vector<Difference> found, const Subject& a, const Subject& b) {
    if (found.empty()) return;
    const std::string cause = cause_of(a, b);
    for (Difference& difference : found) {
      difference.cause = cause;
      result_.differences.push_back(std::move(difference));
    }
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
    keep(std::move(found), a, b);
  }

  void miss(Pairs& pairs, const std::vector<Subject>& before) {
    std::vector<bool> is_used(options_.allowed.size());
    std::vector<const Subject*> unexpected;
    for (const Subject* subject : pairs.only_before) {
      const auto entry = entry_for(options_.allowed, *subject);
      if (entry == options_.allowed.end()) {
        unexpected.push_back(subject);
        result_.only_before.push_back(subject->title);
        continue;
      }
      result_.allowed.push_back({subject->title, entry->reason});
      is_used[static_cast<std::size_t>(entry - options_.allowed.begin())] = true;
    }
    for (const Subject* subject : pairs.only_after) result_.only_after.push_back(subject->title);
    result_.other_terms = take_other_terms(unexpected, pairs.only_after);
    result_.lack = lack_text(unexpected, before);
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

  void remark(std::size_t number, const char* noun, const std::string& text) {
    if (number > 0) result_.remarks.push_back(fmt::format("{} {}", counted(number, noun), text));
  }

  void add_remarks() {
    std::vector<std::string> targets;
    for (const Tolerance& tolerance : kTolerances) targets.emplace_back(tolerance.name);
    remark(
        result_.chaotic, "chaotic cell",
        fmt::format("judged by status and by which of the targets {} it reaches: the figures "
                    "moved by more than a tenth of the tolerance when the start was perturbed in "
                    "the last bit",
                    joined(targets)));
    remark(too_few_, "cell",
           fmt::format("with too few repetitions for a verdict on time: {} a side are needed (run "
                       "--repeat {} --exclusive)",
                       kLeastRepetitions, kLeastRepetitions));
    remark(senseless_, "timing", "left out: not positive and finite");
    remark(other_processors_, "cell", "timed on another processor: times are not comparable");
    remark(skipped_, "cell",
           fmt::format("more with enough repetitions; time is judged on the {} slowest "
                       "(--time-cells lists others)",
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

// Concludes: worse before not comparable before better; each with its cause in the same sentence.

namespace {

// "26 cells of adam, most in sine × adam, seed 0: loss 1e-3 → 2": of what rounding does not
// explain.
std::string worst_text(const GateResult& result, Change change) {
  const Difference* worst = nullptr;
  std::set<std::string> cells, optimizers;
  for (const Difference& difference : result.differences) {
    if (difference.change != change || difference.is_rounding) continue;
    if (worst == nullptr) worst = &difference;  // they come worst first
    cells.insert(difference.key);
    optimizers.insert(difference.optimizer);
  }
  if (worst == nullptr) return "";
  return fmt::format("{} of {}, most in {}: {}", counted(cells.size(), "cell"),
                     names_text({optimizers.begin(), optimizers.end()}), worst->title,
                     step_text(*worst));
}

std::string lack_cause(const GateResult& result) {
  if (result.only_before.empty()) return "";
  std::vector<std::string> names;
  for (const OtherTerms& terms : result.other_terms)
    names.push_back(fmt::format("{} with another budget in NEW, {}", terms.cells, terms.what));
  if (!result.lack.empty()) names.push_back(result.lack);
  return fmt::format("NEW lacks {} of BASE ({})", counted(result.only_before.size(), "cell"),
                     joined(names));
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
                                         worst_text(result, Change::worse),
                                         rounding_cause(result, Change::worse), slower}));
  else if (result.joined == 0)
    settle(kNotComparable, "not comparable: no cell is in both");
  else if (!result.incomparable.empty())
    settle(kNotComparable, with_causes("not comparable in part, nothing worse in the rest",
                                       {incomparable_cause(result.incomparable)}));
  else if (has(Change::better) || !faster.empty())
    settle(kBetterOnly,
           with_causes("better, nothing worse",
                       {settings_cause(result.settings), worst_text(result, Change::better),
                        rounding_cause(result, Change::better), faster}));
  else if (has(Change::changed) || !result.settings.empty())
    settle(kGood,
           with_causes("changed, neither better nor worse", {settings_cause(result.settings)}));
  else
    settle(kGood, "equal");
}

// Reads the two sides of a comparison: result folders, or a baseline and a folder.

namespace {

namespace fs = std::filesystem;

struct Side {
  fs::path path;
  Json file;  // null of a result folder

  bool is_folder() const { return file.is_null(); }
  bool is_baseline() const {
    return file.is_object() && file.value("schema", "") == kBaselineSchema;
  }
};

Side side_of(const fs::path& path) {
  require(is_there(path),
          [&] { return fmt::format("{}: no such result folder or baseline", path.string()); });
  std::error_code unknown;
  return {path, fs::is_directory(path, unknown) ? Json() : read_json(path)};
}

void remark_on(const FolderSubjects& found, const fs::path& path,
               std::vector<std::string>& remarks) {
  if (found.unreadable > 0)
    remarks.push_back(fmt::format("{} of {} could not be read", counted(found.unreadable, "file"),
                                  path.string()));
  if (found.superseded > 0)
    remarks.push_back(fmt::format("{} of {} left aside for newer builds of the same cells",
                                  counted(found.superseded, "older record"), path.string()));
}

GateResult compare_with_baseline(const Side& before, const fs::path& after,
                                 const GateOptions& options) {
  const Baseline baseline = baseline_from_json(before.file);
  const FolderSubjects found = read_subjects(after, baseline.minima, options.listener);
  GateResult result = compare_subjects(baseline.subjects, found.subjects, options);
  result.remarks.push_back("a baseline holds no times: none is judged");
  remark_on(found, after, result.remarks);
  return result;
}

GateResult compare_folders(const fs::path& before, const fs::path& after,
                           const GateOptions& options) {
  const FolderSubjects old = read_subjects(before, std::nullopt, options.listener);
  const FolderSubjects now = read_subjects(after, old.best, options.listener);
  GateResult result = compare_subjects(old.subjects, now.subjects, options);
  remark_on(old, before, result.remarks);
  remark_on(now, after, result.remarks);
  return result;
}

}  // namespace

GateResult compare_results(const fs::path& before, const fs::path& after,
                           const GateOptions& options) {
  const Side old = side_of(before), now = side_of(after);
  require(now.is_folder() && (old.is_folder() || old.is_baseline()),
          "compare takes two result folders, or a baseline and a result folder: "
          "isoline compare BASE RESULTS");
  return old.is_baseline() ? compare_with_baseline(old, after, options)
                           : compare_folders(before, after, options);
}

}  // namespace isoline::reports
