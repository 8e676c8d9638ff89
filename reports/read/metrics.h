// By what runs are measured, the tolerances of success, and what a run cost at measured prices.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/ladder.h"
#include "core/real.h"
#include "core/records/record.h"
#include "core/records/sheet.h"

namespace isoline::reports {

enum class Measure {
  work,        // oracle calls at declared prices, in forward solves: any machine repeats it
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
// What costs are compared in: below one of it they count as one. A time is in microseconds.
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

struct Yardstick {
  Measure by = Measure::work;
  std::array<Tolerance, kTolerances.size()> tolerances = kTolerances;  // the headline's last

  const Tolerance& tightest() const { return tolerances[kTightest]; }
};
// The usual one with another tolerance for its headline, and two looser ones below it.
Yardstick yardstick_at(Measure by, Real tau);

// A value for each measure and tolerance.
template <class Value>
class ByMeasure {
 public:
  using Values = std::array<Value, kTolerances.size()>;

  explicit ByMeasure(const Value& everywhere = {}) {
    for (Values& values : values_) values.fill(everywhere);
  }
  Values& operator[](Measure measure) { return values_[static_cast<std::size_t>(measure)]; }
  const Values& operator[](Measure measure) const {
    return values_[static_cast<std::size_t>(measure)];
  }

 private:
  std::array<Values, kMeasures.size()> values_;
};

// What runs cost in equivalent forward solves: their raw counts at the measured prices of their
// problem. Where nothing was measured, or too short a call to be told, at the declared ones.

// A shorter call takes mostly what a call takes, whatever is called: its price is not its own.
inline constexpr Real kShortestCall = 1e-6;  // seconds
bool is_told(const MeasuredPrices& prices, const MeasuredPrice& price);

class Prices {
 public:
  Prices() = default;
  explicit Prices(const Sheet* sheet);  // of this very problem; may be null

  bool are_measured() const { return !measured_.empty(); }  // any that is told
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

}  // namespace isoline::reports
