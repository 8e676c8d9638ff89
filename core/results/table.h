// The table of runs: one row per run, read from records, or per planned run that is missing, and
// the operations that reports, comparisons and predictions are made of: where, group, aggregate,
// join, pivot.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/results/statistics.h"
#include "core/results/study.h"

namespace isoline::results {

// Facts that a reader must know before comparing a method or a run with others.
struct Marks {
  bool has_extra_information = false;  // †: it sees what others do not
  bool is_foreign = false;             // ‡: another program computes it
  bool is_imported = false;            // §: its figures are claims of others
};
std::string marks_text(const Marks& marks);  // " ‡ † §" of those that apply

// "--iterations 1000 --work 50": what of a budget is not as usual, and the iterations.
std::string budget_options(const Request& request);
// The log relative error of the point that a run returned; 0 of one that failed.
Real returned_digits(const Record& record);

// A row. One that is missing has no record: its problem, optimizer and seed alone are known.
struct Run {
  const Record* record = nullptr;
  std::size_t problem = 0, optimizer = 0;  // indices
  std::uint64_t seed = 0;
  Aim aim = Aim::loss;                  // of its problem: which success counts
  Real minimum = 0;                     // f_L; where it is unknown the best loss of any run
  Real scale = 0;                       // s of f ≤ f_L + τ s
  std::vector<Reached> targets = {};    // of its aim: those that it met
  std::size_t loss_met = 0, x_met = 0;  // how many it met of either kind
  // How many of `targets` the returned point meets: a method that passes a good point and returns a
  // worse one has not solved the problem.
  std::size_t returned_met = 0;
  Real spent = 0;              // in all, in equivalent forward solves at the prices of its problem
  bool is_timed_alone = true;  // no other run beside it: its times mean something
  bool is_repeated = false;    // its record stands in another row, too, and is counted there

  // Until it met a target of its aim; infinite where it never did, or where its returned point does
  // not meet it.
  Real taken(Measure by, std::size_t target) const {
    return target < returned_met ? taken_by_best(by, target) : kNever;
  }
  // By the best evaluated point, as curves and running times show it.
  Real taken_by_best(Measure by, std::size_t target) const {
    return target < targets.size() ? targets[target].by(by) : kNever;
  }
  Real spent_by(Measure by) const;  // in all
};

// The remaining loss at each kept point, (f − f_L) / s; infinite if s is not a valid scale.
std::vector<Real> losses_left(const Run& run);

struct ProblemAxis {
  std::string spec, name;
  std::string label = {};        // of what another program computes: what it calls itself, or empty
  bool is_foreign = false;       // another program computes it
  bool is_unchecked = false;     // so does one that was not checked before the runs: a user's own
  const Sheet* sheet = nullptr;  // none where the folder has none
  Prices prices = {};            // measured only where the sheet is of this very spec
  bool is_minimum_known = true;  // otherwise its runs have distances from the best of them alone
  bool is_least_of_runs = false;  // and the best of them counts as the least loss: a user's own
  Aim aim = Aim::loss;            // what its user wants, as its records say
  bool is_learned = false;
  Real noise = 0;             // in its data, over their rms
  bool is_bounded = false;    // its unknowns have bounds
  bool has_failures = false;  // some of its calls fail
  // For an aim in x: the least error that counts as solved, 1.1 of the floor, over ‖x*‖; the median
  // over seeds.
  Real least_goal = 0;

  // Where even the best possible x is this far off, being solved means little.
  bool is_ill_posed() const {
    constexpr Real kMostError = 0.1;
    return least_goal > kMostError;
  }
  // Whether any loss counts as solved, and which, is then unknown.
  bool lacks_least_loss() const {
    return !is_minimum_known && !is_least_of_runs && aim == Aim::loss && !is_learned;
  }
  // Problems that share an operator; older metadata say nothing of it.
  const std::string& family() const {
    return sheet == nullptr || sheet->family.empty() ? name : sheet->family;
  }
  bool is_linear() const { return sheet != nullptr && sheet->linear && !is_learned; }
  bool has_own_sheet() const { return sheet != nullptr && sheet->spec == spec; }
  // "toy", "physics", "classical", "learned"; "other" where its sheet says nothing.
  std::string group() const {
    if (is_learned) return "learned";
    return sheet == nullptr || sheet->group.empty() ? "other" : sheet->group;
  }
};

// How an optimizer did on the settings on which it is compared.
struct Standing {
  std::size_t settings = 0;  // so many
  std::size_t solved = 0;    // settings whose median work is finite
  std::size_t wins = 0;      // settings on which its median work is the least, ties counted for all
  std::size_t runs = 0;      // of these settings, inapplicable ones left out
  std::size_t reached = 0;   // of them, those that reach the tolerance
  Real typical = kNever;     // the middle of its work over the least, in logarithms, ✗ included
  Real score = 0;            // area of its profile up to kProfileEnd times the least work
};

struct OptimizerAxis {
  std::string label;   // its spec; its name alone where a file of rates chose the options
  std::string brief;   // the same, where it is long with the options alone that tell it apart
  std::string method;  // its name
  // Where a method sees more on some problems than on others, each meaning has a row of its own:
  // "sip, given P⁻¹" and "sip". Then all of them stand under this label.
  std::string whole;
  bool is_meaning = false;
  bool is_foreign = false;   // another program runs it
  bool has_budgets = false;  // another row has its runs with another budget
  const Sheet* sheet = nullptr;
  std::vector<std::string> privileges;                   // on any problem
  bool is_imported = false;                              // some run of it is a claim of others
  std::size_t planned = 0, applicable = 0;               // problems asked of it; that it can treat
  std::size_t runs = 0, failed = 0;                      // inapplicable ones left out
  std::array<Standing, kTolerances.size()> standings{};  // by tolerance

  const Standing& tightest() const { return standings[kTightest]; }
  Marks marks() const { return {!privileges.empty(), is_foreign, is_imported}; }
  std::string family() const { return sheet == nullptr ? "" : sheet->family; }
  // The kind of its step by its mathematics; "other" if its metadata are older.
  std::string mathematics() const {
    return sheet == nullptr || sheet->mathematics.empty() ? "other" : sheet->mathematics;
  }
  std::string name_of_all() const { return is_meaning ? whole : label; }
};

using Rows = std::vector<std::size_t>;  // indices of runs

struct Table {
  const Study* study = nullptr;           // must outlive the table
  std::vector<ProblemAxis> problems;      // by spec
  std::vector<OptimizerAxis> optimizers;  // by label, until they are ranked
  std::vector<Run> runs = {};             // by problem, optimizer and seed
  std::vector<Run> absent = {};           // planned ones that no record answers
  std::vector<PlannedCell> missing = {};  // what these were planned as
  std::size_t planned = 0, answered = 0;
  std::map<Status, std::size_t> statuses = {};
  Rows failures = {};
  std::vector<std::uint64_t> seeds = {};
  bool is_any_timed_together = false;

  template <class Keep>  // keep(run)
  Rows where(const Rows& rows, Keep keep) const {
    Rows kept;
    for (const std::size_t row : rows)
      if (keep(runs[row])) kept.push_back(row);
    return kept;
  }
  template <class Key>  // by key(run)
  auto group(const Rows& rows, Key key) const {
    std::map<decltype(key(runs[0])), Rows> groups;
    for (const std::size_t row : rows) groups[key(runs[row])].push_back(row);
    return groups;
  }
  // The median of value(run) and its spread; so many runs that are missing count as infinite.
  template <class Value>
  Spread aggregate(const Rows& rows, Value value, std::size_t lacking = 0) const {
    std::vector<Real> values(lacking, kNever);
    for (const std::size_t row : rows) values.push_back(value(runs[row]));
    return spread_of(std::move(values));
  }
  // Pairs of rows with the same key(run).
  template <class Key>
  std::vector<std::pair<std::size_t, std::size_t>> join(const Rows& left, const Rows& right,
                                                        Key key) const {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    const auto others = group(right, key);
    for (const std::size_t row : left)
      if (const auto at = others.find(key(runs[row])); at != others.end())
        for (const std::size_t other : at->second) pairs.emplace_back(row, other);
    return pairs;
  }
};

Table table_of(const Study& study);

// Long labels keep only the options that distinguish them within their method. Options with equal
// values in all are omitted: in "sip[inverse=newton,network-optimizer=adam[rate=1e-3]]" beside
// "sip[inverse=analytic,network-optimizer=adam[rate=1e-3]]", the network's optimizer. No two labels
// become equal.
std::vector<std::string> brief_labels(const std::vector<std::string>& labels);

// A value for each measure and tolerance.
template <class Value>
class ByMeasure {
 public:
  using Values = std::array<Value, kTolerances.size()>;

  Values& operator[](Measure measure) { return values_[static_cast<std::size_t>(measure)]; }
  const Values& operator[](Measure measure) const {
    return values_[static_cast<std::size_t>(measure)];
  }

 private:
  std::array<Values, kMeasures.size()> values_{};
};

// One problem and one optimizer, over seeds: an entry of the pivoted table.
struct Cell {
  Rows runs;                // by seed
  std::size_t planned = 0;  // runs.size(), and seeds that were asked for and are missing
  std::size_t failed = 0;   // runs that went wrong: see is_failure()
  std::map<Status, std::size_t> statuses;
  std::array<std::vector<Real>, kMeasures.size()> medians;  // to each target whose median is finite
  ByMeasure<Spread> taken;                                  // to each tolerance
  std::array<Spread, kTolerances.size()> headline;          // of them what the yardstick counts
  // The least median of the problem, ties all: on common settings of the ranked ones, and of
  // another that needs no more.
  std::array<bool, kTolerances.size()> is_best{};
  std::array<bool, kTolerances.size()> is_bound{};  // of some run: it took at most that
  Spread loss, x_error;                             // at the end; x_error.n = 0: no truth is known
  std::string inapplicable;                         // why the pair makes no sense, or empty
  std::vector<std::string> privileges;
  bool is_timed_alone = true;

  bool is_measured() const { return !runs.empty() && inapplicable.empty(); }
  std::size_t missing() const { return planned - runs.size(); }
  Real median(Measure by, std::size_t target) const {  // infinite where half never met it
    const std::vector<Real>& finite = medians[static_cast<std::size_t>(by)];
    return target < finite.size() ? finite[target] : kNever;
  }
};
using Pivot = std::vector<std::vector<Cell>>;  // [problem][optimizer]
Pivot pivot(const Table& table, const Yardstick& yardstick);

// Adds those that are not there yet.
void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some);

// Indices of the problems of each family: settings of one are no two witnesses.
std::map<std::string, std::vector<std::size_t>> problems_by_family(const Table& table);

}  // namespace isoline::results
