// Combines medians of figures, and resamples seeds.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/json.h"
#include "core/results/tests.h"
#include "reports/sections/claims.h"

namespace isoline::reports {
namespace {

constexpr Real kAbsent = std::numeric_limits<Real>::quiet_NaN();

// Least squares of log m over log at.
Real slope(const std::vector<Real>& m, const std::vector<Real>& at) {
  Real mean_x = 0, mean_y = 0, xy = 0, xx = 0;
  const auto n = static_cast<Real>(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) {
    mean_x += std::log(at[i]) / n;
    mean_y += std::log(m[i]) / n;
  }
  for (std::size_t i = 0; i < m.size(); ++i) {
    const Real dx = std::log(at[i]) - mean_x;
    xy += dx * (std::log(m[i]) - mean_y);
    xx += dx * dx;
  }
  return xy / xx;
}

// Linear in the logarithms between the two values of `at` where the ratio passes 1.
Real crossing(const std::vector<Real>& m, const std::vector<Real>& at) {
  const std::size_t half = m.size() / 2;
  const auto excess = [&](std::size_t i) { return std::log(m[i] / m[half + i]); };
  for (std::size_t i = 0; i + 1 < half; ++i) {
    const Real before = excess(i), after = excess(i + 1);
    if (before < 0 && after >= 0)
      return at[i] * std::pow(at[i + 1] / at[i], before / (before - after));
  }
  return kNever;
}

// Kendall's τ with the order of the terms: pairs in it, less those in the opposite one, over all.
Real order(const std::vector<Real>& m) {
  Real with = 0, pairs = 0;
  for (std::size_t i = 0; i < m.size(); ++i)
    for (std::size_t j = i + 1; j < m.size(); ++j, ++pairs)
      with += m[i] < m[j] ? 1 : m[i] > m[j] ? -1 : 0;
  return with / pairs;
}

// The first half of the terms over the second.
std::vector<Real> ratios(const std::vector<Real>& m) {
  const std::size_t half = m.size() / 2;
  std::vector<Real> all;
  for (std::size_t i = 0; i < half; ++i) all.push_back(m[i] / m[half + i]);
  return all;
}

// The place of the first term, from 1; terms equal to it share their places.
Real position(const std::vector<Real>& m) {
  const auto nearer = std::ranges::count_if(m, [&](Real other) { return other < m[0]; });
  const auto equal = std::ranges::count(m, m[0]) - 1;
  return 1 + static_cast<Real>(nearer) + static_cast<Real>(equal) / 2;
}

Chosen chosen_of(const Term& term, const std::vector<std::size_t>& seeds) {
  std::optional<Chosen> chosen;
  for (std::size_t i = 0; i < term.figures.size(); ++i) {
    std::vector<Real> values;
    for (const std::size_t seed : seeds) values.push_back(term.figures[i].at(seed));
    const bool is_absent = std::ranges::all_of(values, [](Real v) { return std::isnan(v); });
    const Real median = is_absent ? kAbsent : term.scale * median_of(std::move(values));
    if (!chosen || (term.is_worst ? median > chosen->level : median < chosen->level))
      chosen = {i, median};
  }
  return chosen.value_or(Chosen{0, kNever});
}

// The seeds of the alternative that counts, whose values reach the term's abscissa.
Real share(const Term& term, const std::vector<std::size_t>& seeds) {
  std::optional<Real> chosen;
  for (const auto& alternative : term.figures) {
    if (std::isnan(alternative.at(seeds[0]))) return kAbsent;
    const auto reach = std::ranges::count_if(
        seeds, [&](std::size_t seed) { return alternative.at(seed) >= term.at; });
    const Real found = static_cast<Real>(reach) / static_cast<Real>(seeds.size());
    if (!chosen || (term.is_worst ? found > *chosen : found < *chosen)) chosen = found;
  }
  return chosen.value_or(kAbsent);
}

Real quantity_over(const std::string& kind, const std::vector<Term>& terms,
                   const std::vector<std::size_t>& seeds) {
  if (kind == "share") return share(terms.at(0), seeds);
  std::vector<Real> medians, at;
  for (const Term& term : terms) {
    medians.push_back(chosen_of(term, seeds).level);
    if (std::isnan(medians.back())) return kAbsent;
    at.push_back(term.at);
  }
  return quantity_of(kind, medians, at);
}

}  // namespace

Chosen chosen_of(const Term& term) {
  Places seeds(term.figures.at(0).size());
  std::iota(seeds.begin(), seeds.end(), 0);
  return chosen_of(term, seeds);
}

Real quantity_of(const std::string& kind, const std::vector<Real>& medians,
                 const std::vector<Real>& at) {
  const Real first = medians.at(0);
  if (kind == "ratio") return first / medians.at(1);
  if (kind == "slope") return slope(medians, at);
  if (kind == "crossing") return crossing(medians, at);
  if (kind == "order") return order(medians);
  if (kind == "ratio_slope") return slope(ratios(medians), at);
  if (kind == "trend") return order(ratios(medians));
  if (kind == "greatest") return std::ranges::max(medians);
  if (kind == "position") return position(medians);
  return first;
}

std::optional<Real> neutral_of(const std::string& kind) {
  if (kind == "ratio") return 1;
  if (kind == "order" || kind == "trend" || kind.ends_with("slope")) return 0;
  return std::nullopt;
}

namespace {

// The quantity of each seed by itself, where it is a number.
std::vector<Real> values_of_seeds(const std::string& kind, const std::vector<Term>& terms) {
  std::vector<Real> values;
  for (std::size_t seed = 0; seed < terms.at(0).figures.at(0).size(); ++seed)
    if (const Real value = quantity_over(kind, terms, {seed}); !std::isnan(value))
      values.push_back(value);
  return values;
}

// Where one further run lies: runs are normal in their logarithms.
std::optional<Interval> prediction_of(const std::vector<Real>& values) {
  std::vector<Real> logarithms;
  for (const Real value : values) {
    if (!(value > 0) || !std::isfinite(value)) return std::nullopt;
    logarithms.push_back(std::log(value));
  }
  if (values.size() < 2) return std::nullopt;
  const auto [low, high] = results::prediction_interval(logarithms);
  return Interval{std::exp(low), std::exp(high)};
}

}  // namespace

Measurement measure(const std::string& kind, const std::vector<Term>& terms,
                    const std::string& stream) {
  Measurement out{.low = kAbsent, .high = kAbsent, .n = terms.at(0).figures.at(0).size()};
  Places seeds(out.n);
  std::iota(seeds.begin(), seeds.end(), 0);
  out.value = quantity_over(kind, terms, seeds);
  std::vector<Real> values = values_of_seeds(kind, terms);
  if (out.n < 2 || values.empty()) return out;
  if (kind == "value" || kind == "ratio" || kind == "greatest")
    out.predicted = prediction_of(values);
  if (out.n < kFewestForInterval) {  // what each of them alone gives and what all do together
    values.push_back(out.value);
    out.low = std::ranges::min(values);
    out.high = std::ranges::max(values);
    return out;
  }
  std::vector<Real> draws;
  resample(out.n, {.component = "claims", .purpose = stream, .is_for_all = true},
           [&](const Places& drawn) {
             const Real value = quantity_over(kind, terms, drawn);
             if (!std::isnan(value)) draws.push_back(value);
           });
  if (draws.empty()) return out;
  const Interval interval = interval_of(std::move(draws));
  out.low = interval.low;
  out.high = interval.high;
  return out;
}

// Bands of what was published, and how an interval lies in them.

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
  if (tolerance.contains("factor")) {
    const Real factor = real_of(tolerance["factor"]);
    return {value / factor, value * factor};
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

// Beyond the band where the claim says that further is better.
bool is_stronger(Real low, Real high, const Agreement& band, const Json& claim) {
  const std::string better = claim.at("published").value("better", "");
  return better == "less" ? high < band.low : better == "greater" && low > band.high;
}

Verdict verdict_on_all(const Measurement& measured, const Json& claim) {
  const bool is_point = std::isnan(measured.low);
  const Real low = is_point ? measured.value : measured.low;
  const Real high = is_point ? measured.value : measured.high;
  const Agreement band = agreement_of(claim);
  const int side = side_of(claim);
  const Real neutral = neutral_of(claim).value_or(0);
  const auto is_on_side = [&](Real value) { return side == 0 || side * (value - neutral) > 0; };
  const bool is_all_on_side = is_on_side(low) && is_on_side(high);
  const bool is_of_one_run = claim.at("published").contains("runs") && measured.predicted;
  const Interval expected = is_of_one_run ? *measured.predicted : Interval{low, high};
  const bool reaches = expected.high >= band.low && expected.low <= band.high;
  const bool is_within = is_of_one_run
                             ? reaches && is_all_on_side && is_of_its_order(measured.value, claim)
                             : band.holds(low) && band.holds(high);
  if (is_within) return Verdict::reproduced;
  if (reaches && is_on_side(measured.value)) return Verdict::consistent;
  if (is_stronger(low, high, band, claim)) return Verdict::stronger;
  const bool is_partly = side != 0 && is_all_on_side && is_of_its_order(measured.value, claim);
  return is_partly ? Verdict::partly : Verdict::not_reproduced;
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
  const Verdict verdict = verdict_on_all(measured, claim);
  if (!is_drawn || measured.n >= kFewestForInterval) return verdict;
  return is_supported(verdict) ? Verdict::consistent : Verdict::at_odds;
}

}  // namespace isoline::reports
