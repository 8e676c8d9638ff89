// Pairs two sets of cells, compares their values and times, and draws a conclusion, as sentences
// and tables for the formats of reports, and as JSON.
#include "reports/compare/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <tuple>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/results/answers.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string change_name(Change change) {
  constexpr const char* kNames[] = {"worse", "better", "changed"};
  return kNames[static_cast<std::size_t>(change)];
}

std::string time_change_name(int change) {
  return change == 0 ? "same" : change > 0 ? "slower" : "faster";
}

// "+5 %, and 3 more of its kind"; "12×" for more than tenfold; no ratio where none says anything.
std::string remainder_text(const Difference& difference) {
  constexpr Real kTimes = 9;
  const Real relative = difference.relative;
  if (relative == 0 || std::abs(relative) == kNever) return difference.note;
  const std::string ratio = relative > kTimes ? fmt::format("{:.3g}×", 1 + relative)
                                              : fmt::format("{}{:.3g} %", relative > 0 ? "+" : "−",
                                                            100 * std::abs(relative));
  return ratio + (difference.note.empty() ? "" : ", " + difference.note);
}

// "adam, gd", or how many there are.
std::string few_names(const std::set<std::string>& names, const char* noun) {
  constexpr std::size_t kFew = 3;
  if (names.size() > kFew) return counted(names.size(), noun);
  return joined({names.begin(), names.end()});
}

// "3 worse, 2 better"; zero counts are omitted.
std::string counts_text(std::initializer_list<std::pair<std::size_t, const char*>> counts) {
  std::vector<std::string> words;
  for (const auto& [number, word] : counts)
    if (number > 0) words.push_back(fmt::format("{} {}", number, word));
  return joined(words);
}

std::string step_text(const Difference& difference) {
  return fmt::format("{} {} → {}", difference.what, difference.before, difference.after);
}

std::string ratio_text(const RatioEstimate& ratio) {
  return fmt::format("{:.3g}× ({:.3g} to {:.3g})", ratio.ratio, ratio.low, ratio.high);
}

std::string cells_text(const CauseGroup& group) {
  return fmt::format("{} of {} on {}", counted(group.cells.size(), "cell"),
                     few_names(group.optimizers, "optimizer"),
                     few_names(group.problems, "problem"));
}

// "3 cells in both: 3 equal; differences: 1 worse".
std::string summary_text(const GateResult& result) {
  const auto count = [&](Change change) {
    return static_cast<std::size_t>(
        std::ranges::count(result.differences, change, &Difference::change));
  };
  const std::string cells = counts_text({{result.equal, "equal"},
                                         {result.chaotic, "chaotic"},
                                         {result.incomparable.size(), "not comparable"}});
  const std::string differences = counts_text({{count(Change::worse), "worse"},
                                               {count(Change::better), "better"},
                                               {count(Change::changed), "changed"}});
  return fmt::format("{} in both{}{}{}{}", counted(result.joined, "cell"),
                     cells.empty() ? "" : ": ", cells,
                     differences.empty() ? "" : "; differences: ", differences);
}

using Row = std::vector<TableCell>;

// A table without rows is left out.
template <class Value, class ToRow>
void add_table(Section& section, const std::string& title, const std::vector<std::string>& columns,
               const std::string& align, const std::vector<Value>& all, ToRow row) {
  if (all.empty()) return;
  Table table{.title = fmt::format("{} ({})", title, all.size()),
              .columns = columns,
              .align = align,
              .names = columns.size() > 1};
  for (const Value& value : all) table.rows.push_back(row(value));
  section.tables.push_back(std::move(table));
}

Row line(const std::string& text) { return {text}; }
Row reasoned(const ReasonedCell& cell) { return {cell.title, cell.reason}; }

// The verdict is its title; then the counts, the causes and what else must be known. Differences
// have a table a cause, in the order of the causes.
Section gate_section(const GateResult& result, bool lists_all) {
  constexpr std::size_t kMostCauses = 8;
  Section section{.id = "comparison", .title = "Comparison: " + result.verdict};
  const auto say = [&](const char* title, const std::string& text) {
    section.readings.push_back({title, text + "."});
  };
  say("", summary_text(result));
  const std::size_t causes = result.causes.size();
  const std::size_t told = lists_all ? causes : std::min(kMostCauses, causes);
  for (const CauseGroup& cause : std::span(result.causes).first(told))
    say("Cause", fmt::format("{}: {}", cause.cause, cause_group_text(cause)));
  if (told < causes)
    say("", fmt::format("{} more; --all lists them", counted(causes - told, "cause")));
  for (const std::string& remark : result.remarks) say("", remark);
  for (const CauseGroup& cause : result.causes) {
    Differences its;
    std::ranges::copy_if(result.differences, std::back_inserter(its),
                         [&](const Difference& one) { return one.cause == cause.cause; });
    add_table(section, "Differences: " + cause.cause, {"", "cell", "figure", "change"}, "llll", its,
              [](const Difference& one) -> Row {
                return {change_name(one.change),
                        one.title,
                        step_text(one),
                        {remainder_text(one), {{"relative", one.relative}}}};
              });
  }
  add_table(section, "Builds that differ", {"part"}, "", result.builds, line);
  add_table(section, "Options that differ", {"option"}, "", result.settings, line);
  add_table(
      section, "Time, NEW over BASE",
      {"", "cell", "ratio (95 % interval)", "noise", "p, adjusted", "runs"}, "llrrrr", result.times,
      [](const TimeVerdict& time) -> Row {
        return {time_change_name(time.change),
                time.title,
                {ratio_text(time.ratio),
                 {{"ratio", time.ratio.ratio}, {"low", time.ratio.low}, {"high", time.ratio.high}}},
                fmt::format("±{}", percent(time.noise)),
                fmt::format("{:.2g}", time.adjusted),
                fmt::format("{}, {}", time.n_before, time.n_after)};
      });
  add_table(section, "Only in BASE", {"cell"}, "", result.only_before, line);
  add_table(section, "At another x", {"cell", "difference"}, "ll", result.elsewhere, reasoned);
  add_table(section, "Allowed", {"cell", "reason"}, "ll", result.allowed, reasoned);
  add_table(section, "Not comparable", {"cell", "reason"}, "ll", result.incomparable, reasoned);
  add_table(section, "Only in NEW", {"cell"}, "", result.only_after, line);
  return section;
}

}  // namespace

std::string cause_group_text(const CauseGroup& group) {
  return fmt::format("{}: {}", cells_text(group),
                     counts_text({{group.count(Change::worse), "worse"},
                                  {group.count(Change::better), "better"},
                                  {group.count(Change::changed), "changed"},
                                  {group.incomparable, "not comparable"}}));
}

std::string gate_terminal(const GateResult& result, bool lists_all) {
  const Section section = gate_section(result, lists_all);
  return terminal_text(section.title) + "\n\n" +
         terminal_section(section, lists_all ? kAllRows : kFewRows);
}

// The rows of each table that a reader reads.
std::string gate_markdown(const GateResult& result) {
  constexpr std::size_t kMostRows = 40;
  Section section = gate_section(result, false);
  for (Table& table : section.tables) {
    if (table.rows.size() <= kMostRows) continue;
    table.caption = fmt::format("{} more rows are omitted here; --json lists them.",
                                table.rows.size() - kMostRows);
    table.rows.resize(kMostRows, {""});
  }
  return markdown_section(section);
}

std::string gate_json(const GateResult& result) {
  Json json = section_json(gate_section(result, true));
  json.update({{"schema", "isoline.comparison/2"},
               {"verdict", result.verdict},
               {"exit_code", static_cast<int>(result.exit_code)},
               {"joined", result.joined},
               {"equal", result.equal},
               {"chaotic", result.chaotic}});
  return json_text(json, 1) + "\n";
}

// --- the gate
namespace {

// Why figures of the two cannot be compared; empty where they can.
std::string why_incomparable(const ComparedCell& a, const ComparedCell& b,
                             const GateOptions& options) {
  for (const ComparedCell* side : {&a, &b})
    if (!side->doubt.empty())
      return fmt::format("{} contradicts itself: {}", side == &a ? "BASE" : "NEW", side->doubt);
  if (a.build == b.build && !a.parts->empty() && *a.parts != *b.parts)
    return "the digests of the parts of this build differ";
  if (a.is_cut || b.is_cut)
    return fmt::format("a time limit or a signal ended the run in {} ({})",
                       b.is_cut ? "NEW" : "BASE", name_of(b.is_cut ? b.status : a.status));
  if (options.tolerance || a.build == b.build) return "";
  return "another build or instruction set; pass --tolerance to compare the values";
}

// "curve", "message, claimed": what of the records differs where all figures agree.
Difference silent_difference(const ComparedCell& a, const ComparedCell& b) {
  const bool is_path = a.trace != b.trace;
  std::vector<std::pair<std::string_view, std::uint64_t>> members;
  if (!is_path && !a.members.empty())  // a baseline holds one digest of them all
    std::ranges::set_symmetric_difference(a.members, b.members, std::back_inserter(members));
  std::set<std::string> names;
  for (const auto& [name, digest] : members) names.emplace(name);
  if (names.empty()) names.insert(is_path ? "trace" : "record");
  Difference difference = difference_in(a, Change::changed, joined({names.begin(), names.end()}),
                                        is_path ? a.trace : a.rest, is_path ? b.trace : b.rest);
  difference.note = is_path ? "the path differs; all compared values are equal"
                            : "the path and all compared values are equal";
  return difference;
}

// Reports group runs by specifications, which one build writes in one way; another build may have
// other defaults. What was typed may differ.
void add_names(Differences& found, const ComparedCell& a, const ComparedCell& b) {
  for (const auto& [was, is] :
       {std::pair(a.problem.get(), b.problem.get()), {a.optimizer.get(), b.optimizer.get()}}) {
    if (was->spec != is->spec)
      found.push_back(difference_in(a, a.build == b.build ? Change::worse : Change::changed,
                                    "specification", was->spec, is->spec));
    else if (was->asked != is->asked)
      found.push_back(difference_in(a, Change::changed, "asked as", was->asked, is->asked));
  }
}

bool has_other_members(const ComparedCell& a, const ComparedCell& b) {
  return !a.members.empty() && !b.members.empty() && a.members != b.members;
}

CauseGroup& group_of(std::vector<CauseGroup>& groups, const std::string& cause) {
  const auto at = std::ranges::find(groups, cause, &CauseGroup::cause);
  if (at != groups.end()) return *at;
  return groups.emplace_back(CauseGroup{.cause = cause});
}

// Why the two of a pair may differ, or that nothing of them explains it.
std::string cause_of(const ComparedCell& before, const ComparedCell& after) {
  const std::set<std::string> options = changed_options(before, after);
  std::vector<std::string> causes(options.begin(), options.end());
  std::ranges::copy(changed_parts(before, after), std::back_inserter(causes));
  return causes.empty() ? "the same build and options" : joined(causes);
}

class Gate {
 public:
  explicit Gate(const GateOptions& options) : options_(options), is_used_(options.allowed.size()) {}

  GateResult run(const std::vector<ComparedCell>& before, const std::vector<ComparedCell>& after) {
    const Pairs pairs = paired(before, after);
    for (const auto& [a, b] : pairs.both) compare(*a, *b);
    for (const ComparedCell* cell : pairs.only_after) {
      result_.only_after.push_back(cell->title);
      if (cell->doubt.empty()) continue;
      result_.incomparable.push_back({cell->title, "NEW contradicts itself: " + cell->doubt});
    }
    add_lack(pairs.only_before);
    name_what_changed();
    choose_timed();
    result_.times = judge_times(timed_, options_.least_noise);
    sort();
    add_remarks();
    return std::move(result_);
  }

 private:
  void compare(const ComparedCell& a, const ComparedCell& b) {
    ++result_.joined;
    for (const std::string& text : changed_parts(a, b)) group_of(parts_, text).add(b);
    for (const std::string& text : changed_options(a, b)) group_of(settings_, text).add(b);
    offer_times(a, b);
    std::string reason = why_incomparable(a, b, options_);
    const std::string criterion = criterion_change_text(a, b, options_.tolerance);
    const bool is_doubtful = !a.doubt.empty() || !b.doubt.empty();
    if (!criterion.empty() && !is_doubtful && !is_allowed(a, true))
      reason = "different success criteria: " + criterion;
    if (reason.empty()) return judge(a, b);
    const auto is_lost = [](const ComparedCell& cell) {  // it went wrong, or does not apply
      return is_failure(cell.status) || cell.status == Status::inapplicable;
    };
    const bool tells_status = a.is_cut || b.is_cut ? badness_of(a.status) != badness_of(b.status)
                                                   : is_lost(a) != is_lost(b);
    if (tells_status && !is_doubtful) return keep({status_difference(a, b)}, a, b);
    result_.incomparable.push_back({a.title, reason});
    CauseGroup& group = group_of(result_.causes, reason);
    group.add(a);
    ++group.incomparable;
  }

  void keep(Differences found, const ComparedCell& a, const ComparedCell& b) {
    if (found.empty()) return;
    const std::string cause = cause_of(a, b);
    CauseGroup& group = group_of(result_.causes, cause);
    group.add(a);
    for (Difference& difference : found) {
      group.changes[difference.change].insert(difference.key);
      difference.cause = cause;
      result_.differences.push_back(std::move(difference));
    }
  }

  void judge(const ComparedCell& a, const ComparedCell& b) {
    Differences found = figure_differences(a, b, options_.tolerance);
    if (a.status != b.status) found.insert(found.begin(), status_difference(a, b));
    // One build takes one path, so that a better one with the same end is a fault.
    if (found.size() == 1 && found[0].what == figure_name(kPath) && a.build == b.build)
      found[0].change = Change::worse;
    const Real apart =
        a.x.empty() || b.x.empty()
            ? 0
            : distance_at_equal_loss(a.figures[kBestLoss], b.figures[kBestLoss], a.scale, a.x, b.x);
    if (apart > 0)
      result_.elsewhere.push_back({a.title, fmt::format("loss equal, x differs by {:.3g}", apart)});
    if (found.empty() && (a.trace != b.trace || a.rest != b.rest || has_other_members(a, b))) {
      if (!a.file.empty() && !b.file.empty())
        found = member_differences(a, b, options_.tolerance, result_.uncompared);
      else if (!options_.tolerance)
        found.push_back(silent_difference(a, b));
    }
    const bool is_coarse = !found.empty() && is_chaotic(a, options_.tolerance);
    if (is_coarse) found = coarse_differences(a, b);
    if (a.key == b.key) add_names(found, a, b);
    result_.equal += found.empty() && !is_coarse;
    result_.chaotic += is_coarse;
    keep(std::move(found), a, b);
  }

  // The first entry of its kind that names the cell.
  bool is_allowed(const ComparedCell& cell, bool is_of_criterion) {
    for (std::size_t i = 0; i < is_used_.size(); ++i) {
      const AllowedCells& entry = options_.allowed[i];
      if (entry.is_of_criterion != is_of_criterion || !is_of(entry, cell)) continue;
      result_.allowed.push_back({cell.title, entry.reason});
      return is_used_[i] = true;
    }
    return false;
  }

  // Another budget is another question: both sides have a cell of that title then.
  void add_lack(const std::vector<const ComparedCell*>& only_before) {
    const std::set<std::string> others(result_.only_after.begin(), result_.only_after.end());
    CauseGroup lacking;
    std::size_t elsewise = 0;
    for (const ComparedCell* cell : only_before) {
      if (is_allowed(*cell, false)) continue;
      result_.only_before.push_back(cell->title);
      lacking.add(*cell);
      elsewise += others.contains(cell->title);
    }
    if (lacking.cells.empty()) return;
    result_.lack = fmt::format("NEW lacks {} that BASE has", cells_text(lacking));
    if (elsewise > 0)
      result_.lack += fmt::format(" ({} with another budget or other threads in NEW)", elsewise);
  }

  void name_what_changed() {
    for (std::vector<CauseGroup>* groups : {&parts_, &settings_})
      std::ranges::sort(*groups, {}, &CauseGroup::cause);
    for (const CauseGroup& group : parts_)
      result_.builds.push_back(fmt::format("{} ({})", group.cause, cells_text(group)));
    for (const CauseGroup& group : settings_)  // which name their component
      result_.settings.push_back(
          fmt::format("{} ({})", group.cause, counted(group.cells.size(), "cell")));
    for (std::size_t i = 0; i < is_used_.size(); ++i)
      if (!is_used_[i])
        result_.remarks.push_back(fmt::format(
            "the file of allowed cells has an entry for {} × {}, but NEW does not {}: remove it",
            options_.allowed[i].problem, options_.allowed[i].optimizer,
            options_.allowed[i].is_of_criterion ? "judge them differently" : "lack them"));
  }

  void offer_times(const ComparedCell& a, const ComparedCell& b) {
    senseless_ += a.senseless_times + b.senseless_times;
    if (std::min(a.seconds.size(), b.seconds.size()) < kLeastRepetitions)
      too_few_ += !a.seconds.empty() && !b.seconds.empty();
    else if (a.processor != b.processor)
      ++other_processors_;
    else
      timed_.push_back({a.key, a.title, a.seconds, b.seconds});
  }

  // The slowest of BASE, which say most and whose choice knows nothing of what changed.
  void choose_timed() {
    if (timed_.size() <= kMostTimed) return;
    skipped_ = timed_.size() - kMostTimed;
    std::ranges::stable_sort(timed_, std::greater(),
                             [](const TimedCell& cell) { return median_of(cell.before); });
    timed_.resize(kMostTimed);
  }

  void sort() {
    std::ranges::stable_sort(result_.differences, {}, [](const Difference& d) {
      return std::tuple(d.change == Change::changed, -d.relative, d.what != "status",
                        std::string_view(d.title));
    });
    std::ranges::stable_sort(result_.causes, std::greater(), [](const CauseGroup& group) {
      return std::tuple(group.count(Change::worse) > 0, group.incomparable > 0, group.cells.size());
    });
  }

  void add_remarks() {
    const std::tuple<std::size_t, const char*, std::string> all[] = {
        {result_.chaotic, "chaotic cell",
         "compared by status and the targets 1e-1, 1e-3 and 1e-6: a change of the start in the "
         "last bit changes the values by more than a tenth of the tolerance"},
        {result_.elsewhere.size(), "cell",
         "with equal losses but different x: the problem has more than one solution, or the loss "
         "does not determine x"},
        {too_few_, "cell",
         fmt::format("with too few repetitions to compare times: use --repeat {} --exclusive",
                     kLeastRepetitions)},
        {senseless_, "time", "omitted: not positive and finite"},
        {other_processors_, "cell", "timed on different processors, so times are not comparable"},
        {skipped_, "cell",
         fmt::format("more with enough repetitions; times are compared for the {} slowest cells",
                     kMostTimed)}};
    for (const auto& [number, noun, text] : all)
      if (number > 0) result_.remarks.push_back(fmt::format("{} {}", counted(number, noun), text));
  }

  const GateOptions& options_;
  std::vector<bool> is_used_;                 // of the entries of the list of allowed cells
  std::vector<CauseGroup> parts_, settings_;  // all that differs, with and without an effect
  std::vector<TimedCell> timed_;
  std::size_t too_few_ = 0, other_processors_ = 0, skipped_ = 0, senseless_ = 0;
  GateResult result_;
};

// "26 cells of adam on sine, most in sine × adam, seed 0: loss 1e-3 → 2".
std::string worst_text(const GateResult& result, Change change) {
  const Difference* worst = nullptr;
  CauseGroup group;
  for (const Difference& difference : result.differences) {  // worst first
    if (difference.change != change) continue;
    if (worst == nullptr) worst = &difference;
    group.cells.insert(difference.key);
    group.problems.insert(difference.problem);
    group.optimizers.insert(difference.optimizer);
  }
  if (worst == nullptr) return "";
  return fmt::format("{}, most in {}: {}", cells_text(group), worst->title, step_text(*worst));
}

std::string time_cause(const std::vector<TimeVerdict>& times, int change, const char* word) {
  const auto count = std::ranges::count(times, change, &TimeVerdict::change);
  if (count == 0) return "";
  const auto first = std::ranges::find(times, change, &TimeVerdict::change);
  return fmt::format("{} {}, {} by {}", counted(static_cast<std::size_t>(count), "cell"), word,
                     first->title, ratio_text(first->ratio));
}

// The sentence and the exit code: worse before not comparable before better, each with its causes.
void conclude(GateResult& result, const GateOptions& options) {
  const auto settle = [&](ExitCode code, const char* verdict, std::vector<std::string> causes) {
    std::erase(causes, "");
    result.exit_code = code;
    result.verdict = verdict + (causes.empty() ? "" : ": " + joined(causes, "; "));
  };
  const std::size_t others = result.settings.empty() ? 0 : result.settings.size() - 1;
  const std::string settings = others == 0
                                   ? joined(result.settings)
                                   : fmt::format("{}, and {} of options", result.settings[0],
                                                 counted(others, "other change"));
  const std::string lack = options.is_common_only ? "" : result.lack;
  const std::string worse = worst_text(result, Change::worse),
                    better = worst_text(result, Change::better),
                    slower = time_cause(result.times, 1, "slower"),
                    faster = time_cause(result.times, -1, "faster");
  if (!worse.empty() || !slower.empty() || !lack.empty()) {
    settle(kWorse, "worse", {settings, lack, worse, slower});
  } else if (result.joined == 0) {
    settle(kNotComparable, "not comparable", {"BASE and NEW have no common cell"});
  } else if (const auto& all = result.incomparable; !all.empty()) {
    const std::string first = all[0].title + ": " + all[0].reason;
    settle(kNotComparable,
           all.size() == result.joined ? "not comparable"
                                       : "partly not comparable, the other cells are not worse",
           {all.size() == 1 ? first : fmt::format("{} cells, such as {}", all.size(), first)});
  } else if (!better.empty() || !faster.empty()) {
    settle(kBetterOnly, "better, not worse in any cell", {settings, better, faster});
  } else {
    const bool is_equal = result.differences.empty() && settings.empty();
    const std::string omitted =
        result.uncompared.empty()
            ? ""
            : "not compared: " + joined({result.uncompared.begin(), result.uncompared.end()});
    settle(kGood, is_equal ? "equal" : "changed, neither better nor worse", {settings, omitted});
  }
}

// The file where it is a baseline; nothing of a folder.
std::optional<std::vector<ComparedCell>> read_baseline(const std::filesystem::path& path) {
  require(is_there(path), [&] {
    return fmt::format(
        "{}: no such result folder or baseline; `isoline run --out FOLDER` "
        "creates a result folder",
        path.string());
  });
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) return std::nullopt;
  const Json json = read_json(path);
  require(json.is_object() && json.value("schema", "") == kBaselineSchema, [&] {
    return path.string() +
           " is not a baseline; compare needs two result folders, or a baseline and a "
           "result folder: isoline compare BASE NEW";
  });
  return baseline_from_json(json, path.string());
}

}  // namespace

void CauseGroup::add(const ComparedCell& cell) {
  cells.insert(cell.key);
  problems.insert(cell.problem->name);
  optimizers.insert(cell.optimizer->name);
}

namespace {

std::set<std::string> specs_of(const std::vector<ComparedCell>& cells) {
  std::set<std::string> specs;
  for (const ComparedCell& cell : cells) specs.insert({cell.problem->spec, cell.optimizer->spec});
  return specs;
}

}  // namespace

GateResult compare_results(const std::filesystem::path& before, const std::filesystem::path& after,
                           const GateOptions& options) {
  auto baseline = read_baseline(before);
  require(!read_baseline(after), "a baseline must be the first argument: isoline compare BASE NEW");
  const FolderCells old =
      baseline ? FolderCells{.cells = std::move(*baseline)} : read_cells(before, options.listener);
  const FolderCells now = read_cells(after, options.listener);
  GateResult result = Gate(options).run(old.cells, now.cells);
  if (!baseline && !options.is_common_only)
    if (const std::string lack = folder_lack(before, after, specs_of(now.cells)); !lack.empty())
      result.lack += (result.lack.empty() ? "" : "; ") + lack;
  if (options.tolerance)
    for (const char* never : {"memory", "times"}) result.uncompared.insert(never);
  conclude(result, options);
  if (baseline) result.remarks.push_back("Baselines do not store times, so times are not compared");
  for (const auto& [found, path] : {std::pair(&old, before), {&now, after}}) {
    if (!found->unreadable.empty())
      result.remarks.push_back(fmt::format(
          "{} of {} could not be read", counted(found->unreadable.size(), "file"), path.string()));
    result.unreadable.insert(result.unreadable.end(), found->unreadable.begin(),
                             found->unreadable.end());
    if (found->superseded > 0)
      result.remarks.push_back(fmt::format("{} of {} omitted: newer builds computed the same cells",
                                           counted(found->superseded, "older record"),
                                           path.string()));
  }
  return result;
}

}  // namespace isoline::reports
