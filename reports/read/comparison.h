// What a study holds: its runs in cells, the cells on two axes, and who stands where. All that a
// report says is computed from it.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/results/statistics.h"
#include "reports/read/lead.h"
#include "reports/read/metrics.h"
#include "reports/read/study.h"

namespace isoline::reports {

// One run: its record and what it took to each tolerance, infinite where never reached.
struct Run {
  const Record* record = nullptr;
  std::size_t problem = 0, optimizer = 0;  // indices
  Aim aim = Aim::loss;                     // of its problem: which success counts
  Real minimum = 0;                        // f_L: declared, else the best known
  Real scale = 0;                          // s of f ≤ f_L + τ s
  ByMeasure<Real> taken{kNever};           // until what its problem aims at
  // Until each kind of success: for tables that hold them against each other.
  ByMeasure<Real> reached_loss{kNever}, found_x{kNever};
  // Read at kept points with others skipped between: it took at most that.
  std::array<bool, kTolerances.size()> is_bound{};
  Real spent = 0;              // in all, in equivalent forward solves at the prices of its problem
  bool is_timed_alone = true;  // no other run beside it: its times mean something
  bool is_repeated = false;    // its record stands in another row, too, and is counted there
};

// One problem and one optimizer, over seeds.
struct Cell {
  std::vector<std::size_t> runs;  // indices, by seed
  std::size_t planned = 0;        // runs.size(), and seeds that were asked for and are missing
  std::size_t failed = 0;         // runs that went wrong: see is_failure()
  std::map<Status, std::size_t> statuses;
  ByMeasure<Spread> taken;
  std::array<Spread, kTolerances.size()> headline;  // of them what the yardstick counts
  // The least median of the problem, ties all: on common settings of the ranked ones, and of
  // another that needs no more.
  std::array<bool, kTolerances.size()> is_best{};
  std::array<bool, kTolerances.size()> is_bound{};  // of some run: it took at most that
  Spread loss, x_error;                             // at the end; x_error.n = 0: no truth is known
  std::string inapplicable;                         // why the pair makes no sense, or empty
  std::vector<std::string> privileges;
  bool is_timed_alone = true;

  bool is_measured() const { return !runs.empty() && inapplicable.empty(); }
};

struct ProblemAxis {
  std::string spec, name;
  std::string label;             // of what another program computes: what it calls itself, or empty
  bool is_foreign = false;       // another program computes it
  const Sheet* sheet = nullptr;  // none where the folder has none
  Prices prices = {};            // measured only where the sheet is of this very spec
  bool is_minimum_declared = true;  // otherwise f_L is the least loss any run of its seed reached
  Aim aim = Aim::loss;              // what its user wants, as its records say
  bool is_learned = false;

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
  bool is_foreign = false;  // another program runs it
  const Sheet* sheet = nullptr;
  std::vector<std::string> privileges;                   // on any problem
  bool is_imported = false;                              // some run of it is a claim of others
  std::size_t planned = 0, applicable = 0;               // problems asked of it; that it can treat
  std::size_t runs = 0, failed = 0;                      // inapplicable ones left out
  std::array<Standing, kTolerances.size()> standings{};  // by tolerance

  const Standing& tightest() const { return standings[kTightest]; }
  std::string family() const { return sheet == nullptr ? "" : sheet->family; }
  // What its step is by its mathematics, whoever wrote it; "other" where its sheet is older.
  std::string mathematics() const {
    return sheet == nullptr || sheet->mathematics.empty() ? "other" : sheet->mathematics;
  }
  std::string name_of_all() const { return is_meaning ? whole : label; }
};

// Methods that were given the very same settings; ranking.h says how they are found.
struct Order {
  std::vector<std::size_t> settings, methods;  // problems; optimizers, best first

  bool has(std::size_t optimizer) const;
  bool has_setting(std::size_t problem) const;
};

// Where a method that is not in the common order would stand.
struct Placed {
  std::size_t optimizer = 0;
  Order among;             // with itself, best first
  std::size_t place = 0;   // 1 the best; ties share the better
  std::size_t shared = 0;  // settings that most methods were given
  std::size_t asked = 0;   // of them those it was given
};

struct Comparison {
  const Study* study = nullptr;  // must outlive the comparison
  Yardstick yardstick;
  std::vector<ProblemAxis> problems;      // by spec
  std::vector<OptimizerAxis> optimizers;  // the common order, best first; then who stands apart
  std::vector<Run> runs;
  std::vector<std::vector<Cell>> cells;              // [problem][optimizer]
  Order order;                                       // the common one: of all tables that compare
  std::vector<Order> other_orders;                   // of settings that only some were given
  std::vector<Placed> apart;                         // who is not in the common order
  std::array<Profile, kTolerances.size()> profiles;  // of the common order
  std::optional<Lead> lead;       // at the tightest tolerance; none where nothing is solved
  std::optional<Lead> open_lead;  // among those without privileges, compared among themselves
  std::size_t planned = 0, answered = 0;
  std::vector<PlannedCell> missing;
  std::map<Status, std::size_t> statuses;
  std::vector<std::size_t> failures;  // runs
  std::vector<std::uint64_t> seeds;
  std::size_t names = 0;  // of problems, options apart
  bool is_any_timed_together = false;

  const Cell& cell(std::size_t problem, std::size_t optimizer) const {
    return cells[problem][optimizer];
  }
};

Comparison compare_optimizers(const Study& study, const Yardstick& yardstick = {});

// costs[p][s]: medians to one tolerance, by the yardstick's measure or another, in its unit;
// nothing where never planned.
Costs median_costs(const Comparison& comparison, std::size_t tolerance);
Costs median_costs(const Comparison& comparison, std::size_t tolerance, Measure by);

// Indices of the problems of each name: settings of one problem are no two witnesses.
std::map<std::string, std::vector<std::size_t>> problems_by_name(const Comparison& comparison);

// The optimizers that ran on a problem, best first: by what the yardstick counts, from the tightest
// tolerance to the loosest, then by final loss; of a learned one by the error in x at equal work.
std::vector<std::size_t> ranking(const Comparison& comparison, std::size_t problem);

}  // namespace isoline::reports
