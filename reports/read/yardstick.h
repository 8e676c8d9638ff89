// By what a report measures: what is counted, and the tolerances at which success is told.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/ladder.h"
#include "core/real.h"

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

}  // namespace isoline::reports
