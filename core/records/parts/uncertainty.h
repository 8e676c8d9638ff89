// The covariance of x where a direct least-squares problem has more residuals than unknowns.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/errors.h"
#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

// x as it was returned, and σ̂² (JᵀJ)⁻¹ there, σ̂² = ‖y − y*‖²/(m − n), as standard deviations and
// correlations.
struct Uncertainty {
  static constexpr Part kPart{
      .member = "uncertainty",
      .law = R"({"description": "Of a least-squares solution: x and its covariance"})"};
  std::vector<Real> x, standard_deviation;
  std::vector<std::vector<Real>> correlation;
  Real variance = 0;                    // σ̂²
  std::int64_t degrees_of_freedom = 0;  // m − n
  Real condition = 0;                   // number of J, its columns scaled to norm 1
};

void fields(Like<Uncertainty> auto& known, auto& field) {
  field("x", known.x);
  field("standard_deviation", known.standard_deviation);
  field("correlation", known.correlation);
  field("variance", known.variance);
  field("degrees_of_freedom", known.degrees_of_freedom);
  field("condition", known.condition);
}

inline void require_sound(const Uncertainty& known) {
  const std::size_t k = known.x.size();
  require(
      known.standard_deviation.size() == k && known.correlation.size() == k &&
          std::ranges::all_of(known.correlation, [&](const auto& row) { return row.size() == k; }),
      "the columns of its standard deviations differ in length");
}

}  // namespace isoline
