// What runs cost in equivalent forward solves: their raw counts at the measured prices of their
// problem. Where nothing was measured, or too short a call to be told, at the declared ones.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/records/record.h"
#include "core/records/sheet.h"

namespace isoline::reports {

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
