// The effort of a run until it met each of 51 targets: by four measures, in loss or in x.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/ladder.h"
#include "core/real.h"
#include "core/records/record.h"
#include "core/records/sheet.h"
#include "core/results/statistics.h"
#include "core/results/study.h"

namespace isoline::results {

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

  const Tolerance& tightest() const { return tolerances[kTightest]; }
};
// The usual one with another tolerance for its headline, and two looser ones below it.
Yardstick yardstick_at(Measure by, Real tau);

// The cost of runs in equivalent forward solves: their raw counts at the measured costs of their
// problem, or at the nominal costs if nothing was measured or a call was too short.

// A shorter call takes mostly what a call takes, whatever is called: its price is not its own.
inline constexpr Real kShortestCall = 1e-6;  // seconds
bool is_told(const MeasuredPrices& prices, const MeasuredPrice& price);

class Prices {
 public:
  Prices() = default;
  explicit Prices(const Sheet* sheet);  // of this very problem; may be null

  bool are_measured() const { return !measured_.empty(); }  // at least one is known
  bool is_measured(std::string_view oracle) const { return measured_.contains(oracle); }

  Real cost(const Record& record) const;  // of all that the run asked
  // At each point of the curve.
  std::vector<Real> curve_costs(const Record& record) const;
  // At each hit, infinite where never reached. Where an older record does not tell the counts at
  // its hits they are read between the points of the curve, by work, which it does tell.
  std::vector<Real> hit_costs(const Record& record) const;

 private:
  Real price(const Record& record, std::size_t kind) const;

  std::map<std::string, Real, std::less<>> measured_;  // by oracle
};

// The raw counts when the declared work of the run was `work`: of its hit, or, in older records, of
// the first kept point from there on.
OracleCounts counts_at(const Record& record, Real work);

// The least loss any run of a problem and seed has reached: f_L where none is declared.
class BestKnown {
 public:
  using Minima = std::map<std::pair<std::string, std::uint64_t>, Real>;  // by problem and seed

  explicit BestKnown(const Study& study);
  explicit BestKnown(Minima least) : least_(std::move(least)) {}
  // Declared, else the best known; not-a-number where no run of its problem and seed is.
  Real minimum(const Record& record) const;
  // s of f ≤ f_L + τ s; f₀ − f_L where older records lack it.
  Real scale(const Record& record) const {
    return record.scale.value_or(record.summary.start_loss - minimum(record));
  }

 private:
  Minima least_;
};

// The counts of a run when it first met a target.
struct Reached {
  Real work = 0, cost = 0, seconds = 0;
  std::int32_t iteration = 0;
  bool is_bound = false;  // kept points were skipped before: at most that

  Real by(Measure measure) const;
};
// The targets τ = 10^(−j/5), j = 0, 1, … until one that it never met. Of losses exact where the
// record has hits; all else is read at the kept points of its curve.
std::vector<Reached> targets_met(const Record& record, const Prices& prices, Aim aim,
                                 const BestKnown& best);

}  // namespace isoline::results
