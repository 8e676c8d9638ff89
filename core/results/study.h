// The input of a report: the plan, the records and the component metadata of result folders; and
// the work of each run to each target.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/real.h"
#include "core/records/record.h"
#include "core/records/request.h"
#include "core/records/sheet.h"
#include "core/results/profile.h"
#include "core/results/statistics.h"
#include "core/status.h"
#include "core/threads.h"

namespace isoline::results {

// A row of a table of rates.
struct TunedRate {
  std::string problem, optimizer;  // the problem's spec, the optimizer's name
  std::string setting;             // the spec that it was found on, if that is another one
  std::string file;                // the table of rates that it stands in
  std::string paper;               // that published it; empty where a grid was tried
  std::string option;              // that was chosen: "rate"
  // For a grid: its values, and the work of each to its tolerance, the median over the tuning
  // seeds; infinite if it was not reached.
  std::vector<Real> values, work;
  // The families that the value was chosen on, of a value for another family, and the mean score of
  // each value there; such a row has no `work`.
  std::vector<std::string> families;
  std::vector<Real> mean_scores;
  std::optional<Real> standard, value;  // the option's default, and what was chosen
  Real spent = 0;                       // nominal work of all trials: of the pair, or of the method
  bool is_at_edge = false;              // the best value is the first or the last

  bool is_tuned() const { return !values.empty(); }
  bool is_left_out() const { return !families.empty(); }
  bool is_ever_solved() const;
  // The work of one of the values; infinite where it was not tried or did not reach the tolerance.
  Real work_of(Real tried) const;
};

std::vector<TunedRate> rates_from_text(const std::string& text, const std::string& origin);

// A file that is no record, sheet or plan. It is listed, so that nothing vanishes in silence.
struct Unreadable {
  std::string file;
  std::string reason;
};

struct Study {
  Plan plan;                 // the union of the folders' plans
  std::vector<Record> runs;  // one a cell, by its newest build; by problem, optimizer, seed
  std::vector<Sheet> sheets;
  std::vector<AuditedOptimizer> audits;  // by name; of several folders the first that has it
  std::vector<TunedRate> rates;          // rows of tables of rates that runs used
  std::vector<ProfiledCell> profiles;    // of fits, by their cells
  std::vector<Unreadable> unreadable;
  std::size_t superseded = 0;      // readable records left aside for a newer one of the same cell
  std::set<std::string> disputed;  // cells of which two records of one build hold other results
  std::vector<std::string> folders;

  // The fields beside a record with their numbers; nothing where it keeps none, or where they
  // cannot be read.
  std::optional<FieldFrames> fields_of(const Record& record) const;
};

// Folders are laid out as core/records/sheet.h says; a missing one is a UsageError. The listener is
// told of the records. `trim` takes out of each record, once it is read, what its reader does not
// use: 100,000 whole ones take more than a gigabyte.
using Trim = std::function<void(Record&)>;
Study read_study(const std::vector<std::string>& folders, const Listener& listener = {},
                 const Trim& trim = {});

// Among all records of a cell the newest counts, independent of its build: what decides between
// them, and the order of several.
struct RunMark {
  std::string cell, build, started, problem, optimizer;  // its digests; when; its specs
  std::uint64_t seed = 0;
  bool is_nondeterministic = false;
};
RunMark mark_of(const Record& record);

struct Newest {
  std::vector<std::size_t> kept;   // one a cell, by problem, optimizer and seed
  std::size_t superseded = 0;      // left aside for a newer one
  std::set<std::string> disputed;  // cells of which two records of one build hold other results
};

// A mark without a cell stands for no record. Whether two of one build hold other results is asked
// only where both should hold the same.
Newest newest_of(const std::vector<RunMark>& marks,
                 const std::function<bool(std::size_t, std::size_t)>& are_at_odds);

// Whether they hold other results, times aside.
bool are_at_odds(const Record& a, const Record& b);

// The files of the records of all folders, as text: each path that knows its parts is a kilobyte.
// If a folder cannot be listed, the reason.
std::vector<std::string> record_files(const std::vector<std::string>& folders,
                                      std::vector<Unreadable>& unreadable);

// The effort of a run until it met each of 51 targets: by four measures, in loss or in x.

enum class Measure {
  work,        // oracle calls at nominal cost, in forward solves, equal on every machine
  cost,        // the same calls at the prices measured on each problem
  iterations,  // steps
  time,        // wall seconds
};
inline constexpr std::array<std::string_view, 4> kMeasureNames = {"work", "cost", "iterations",
                                                                  "time"};
inline constexpr std::array kMeasures = {Measure::work, Measure::cost, Measure::iterations,
                                         Measure::time};
inline std::string_view name_of(Measure measure) {
  return kMeasureNames[static_cast<std::size_t>(measure)];
}
std::optional<Measure> measure_of(std::string_view name);
// The unit of costs: costs below one unit count as one. A time is in microseconds.
inline Real least_unit(Measure measure) { return measure == Measure::time ? 1e-6 : 1; }

// τ of a success: f ≤ f_L + τ s, or an error in x of τ times the solution's norm. Always a rung of
// the ladder, since that is where records tell what was reached.
struct Tolerance {
  std::string_view name;  // "1e-6", for good
  Real tau = 0;
  std::size_t rung = 0;
};
// The rung at τ, or the next stricter one.
Tolerance tolerance_at(Real tau);

inline constexpr std::array<Tolerance, 3> kTolerances = {
    {{"1e-1", 1e-1, 5}, {"1e-3", 1e-3, 15}, {"1e-6", 1e-6, 30}}};
inline constexpr std::size_t kTightest = kTolerances.size() - 1;
inline constexpr std::size_t kTargets = kRungs;

struct Yardstick {
  Measure by = Measure::work;
  std::array<Tolerance, kTolerances.size()> tolerances = kTolerances;  // the headline's last
  bool has_contrasts = false;  // the suite names some: the settings that they are on are ranked

  const Tolerance& tightest() const { return tolerances[kTightest]; }
};
// The usual one with another tolerance for its headline, and two looser ones below it.
Yardstick yardstick_at(Measure by, Real tau);

// The cost of runs in equivalent forward solves: their raw counts at the measured costs of their
// problem, or at the nominal costs if nothing was measured or a call was too short.

// A shorter call takes mostly what a call takes, whatever is called: its price is not its own.
inline constexpr Real kShortestCall = 1e-6;  // seconds
bool is_told(const MeasuredPrices& prices, const MeasuredPrice& price);

using Columns = std::map<std::string, std::vector<std::int64_t>>;  // by oracle

class Prices {
 public:
  Prices() = default;
  explicit Prices(const Sheet* sheet);  // of this very problem; may be null

  bool are_measured() const { return !measured_.empty(); }  // at least one is known
  bool is_measured(std::string_view oracle) const { return measured_.contains(oracle); }

  Real cost(const Record& record) const;  // of all that the run asked
  // The processor time of all that the run asked; nothing where some of it was not measured.
  std::optional<Real> seconds(const Record& record) const;
  Real price(const Record& record, std::size_t kind) const;
  // At each point of the curve.
  std::vector<Real> curve_costs(const Record& record) const;
  // At each hit, infinite where never reached.
  std::vector<Real> hit_costs(const Record& record, const Hits& hits) const;

 private:
  // From counts by oracle in columns as long as `work`, which it is where nothing is measured.
  std::vector<Real> costs_of(const Record& record, const Columns& counts,
                             const std::vector<std::int64_t>& work) const;

  std::map<std::string, Real, std::less<>> measured_;  // by oracle
  Real forward_seconds_ = 0;
};

// The raw counts when the declared work of the run was `work`: of its hit, or, in older records, of
// the first kept point from there on.
OracleCounts counts_at(const Record& record, Real work);
// The rounds of one of kWorkers there; `work` itself of a single worker, and of records without
// rounds.
Real rounds_at(const Record& record, Real work, std::int64_t workers);

// Whether the loss counts from the least one of these records where none is declared.
inline bool is_of_own_problem(const Record& record) {
  return record.foreign.problem && !record.imported && !record.request.problem.is_learned;
}

// The least loss any run of a problem and instance has reached: what distances are measured from
// where f_L is unknown.
class BestKnown {
 public:
  explicit BestKnown(const Study& study);
  // f_L where it is known; not-a-number where no run of its problem and instance is.
  Real minimum(const Record& record) const;
  // s of f ≤ f_L + τ s; f₀ − f_L where older records lack it. Of a user's own problem whose least
  // loss is that of these runs, at most this loss: s of data with noise.
  Real scale(const Record& record) const {
    const Real least = minimum(record), above = record.summary.start_loss - least;
    const bool is_of_runs = is_of_own_problem(record) && !record.minimum && least > 0;
    return record.scale.value_or(is_of_runs && least < above ? least : above);
  }

 private:
  std::map<std::pair<std::string, std::uint64_t>, Real> least_;  // by problem and instance
};

// The counts of a run when it first met a target.
struct Reached {
  Real work = 0, cost = 0, seconds = 0;
  std::int32_t iteration = 0;
  bool is_bound = false;  // kept points were skipped before: at most that

  Real by(Measure measure) const;
};
// The targets τ = 10^(−j/5), j = 0, 1, … until one that it never met. Of losses exact where the
// record has hits; all else is read at the kept points of its curve. Of losses none where f_L is
// unknown, but of a user's own problem.
std::vector<Reached> targets_met(const Record& record, const Prices& prices, Aim aim,
                                 const BestKnown& best);

}  // namespace isoline::results
