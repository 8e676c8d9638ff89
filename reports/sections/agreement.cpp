// Bands of what was published, and how an interval lies in them.
#include "reports/sections/agreement.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/sections/claim_terms.h"

namespace isoline::reports {

using Json = nlohmann::json;
namespace {

// The error of a slope whose two ends were each read with relative error t.
Real slope_error(Real t, const Json& terms) {
  Real least = kNever, most = 0;
  for (const Json& term : terms) {
    least = std::min(least, term.at("at").get<Real>());
    most = std::max(most, term.at("at").get<Real>());
  }
  return std::log((1 + t) / (1 - t)) / std::log(most / least);
}

Agreement around(Real value, const Json& claim) {
  const Json& tolerance = claim.at("tolerance");
  if (tolerance.contains("absolute")) {
    const Real error = real_of(tolerance["absolute"]);
    return {value - error, value + error};
  }
  if (!tolerance.contains("relative")) return {value, value};
  const Real t = real_of(tolerance["relative"]);
  const Json& quantity = claim.at("quantity");
  if (quantity.at("kind") == "slope") {
    const Real error = slope_error(t, quantity.at("terms"));
    return {value - error, value + error};
  }
  // A ratio of two values that were each read with error t.
  if (tolerance.value("values", 1) == 2)
    return {value * (1 - t) / (1 + t), value * (1 + t) / (1 - t)};
  return {value * (1 - t), value * (1 + t)};
}

std::optional<Real> neutral_of(const Json& claim) {
  return reports::neutral_of(claim.at("quantity").at("kind").get<std::string>());
}

// 1 where what was published lies above the tie, −1 below it, 0 where it says no such thing.
int side_of(const Json& claim) {
  const auto neutral = neutral_of(claim);
  if (!neutral) return 0;
  const Json& published = claim.at("published");
  const Real value = published_value(published);
  if (published.contains("at_least")) return value >= *neutral ? 1 : 0;
  if (published.contains("at_most")) return value <= *neutral ? -1 : 0;
  return value == *neutral ? 0 : value > *neutral ? 1 : -1;
}

// How far from a tie, in what adds up: logarithms of ratios.
Real effect(const Json& claim, Real value) {
  return claim.at("quantity").at("kind") == "ratio" ? std::log(value) : value;
}

constexpr Real kFewestThirds = 1.0 / 3, kMostThirds = 3;

bool is_of_its_order(Real value, const Json& claim) {
  const Json& published = claim.at("published");
  const Real share = effect(claim, value) / effect(claim, published_value(published));
  const bool has_ceiling = published.contains("value");
  return share >= kFewestThirds && (!has_ceiling || share <= kMostThirds);
}

}  // namespace

Agreement agreement_of(const Json& claim) {
  const Json& published = claim.at("published");
  Agreement band = around(published_value(published), claim);
  if (published.contains("at_least")) band.high = kNever;
  if (published.contains("at_most")) band.low = -kNever;
  const int side = side_of(claim);
  const Real neutral = neutral_of(claim).value_or(0);
  if (side > 0 && band.low <= neutral) {
    band.low = neutral;
    band.is_low_open = true;
  }
  if (side < 0 && band.high >= neutral) {
    band.high = neutral;
    band.is_high_open = true;
  }
  return band;
}

Verdict verdict_of(const Measurement& measured, const Json& claim, bool is_drawn) {
  const bool is_point = std::isnan(measured.low);
  const Real low = is_point ? measured.value : measured.low;
  const Real high = is_point ? measured.value : measured.high;
  const Agreement band = agreement_of(claim);
  if (band.holds(low) && band.holds(high))
    return is_point && is_drawn ? Verdict::consistent : Verdict::reproduced;
  const int side = side_of(claim);
  const Real neutral = neutral_of(claim).value_or(0);
  const auto is_on_side = [&](Real value) { return side * (value - neutral) > 0; };
  const bool reaches = high >= band.low && low <= band.high;
  if (reaches && (side == 0 || is_on_side(measured.value))) return Verdict::consistent;
  const bool is_partly =
      side != 0 && is_on_side(low) && is_on_side(high) && is_of_its_order(measured.value, claim);
  return is_partly ? Verdict::partly : Verdict::not_reproduced;
}

}  // namespace isoline::reports
