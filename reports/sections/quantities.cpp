// Values of runs, of their curves and of their paths; quantities computed from medians of these
// values; and their agreement with published values.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <ranges>

#include "core/json.h"
#include "core/records/sheet.h"
#include "core/results/statistics.h"
#include "reports/sections/claims.h"
#include "reports/sections/figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {

using Json = nlohmann::json;

namespace {

constexpr std::string_view kSeries = "series: ";
constexpr std::string_view kUntil = "until: ";  // then a column, and what it falls to
constexpr std::string_view kWork = "work ";     // before `until`

// Running means begin with the first step: before it, what that saw.
Real value_at(const std::vector<Real>& column, std::size_t index) {
  const bool is_before_any = index == 0 && std::isnan(column[0]) && column.size() > 1;
  return column.at(is_before_any ? 1 : index);
}

template <class Map, class Key>
const std::vector<Real>* found_in(const Map& columns, const Key& key) {
  const auto found = columns.find(key);
  return found == columns.end() ? nullptr : &found->second;
}

const std::vector<Real>* column_of(const Record& record, const std::string& name) {
  const Curve& curve = record.curve;
  if (name == "x_error") return &curve.x_error;
  if (name == "loss") return &curve.loss;
  if (name == "gradient_norm") return &curve.gradient_norm;
  if (name == "step_norm") return &curve.step_norm;
  if (name.starts_with(kSeries)) return found_in(record.series, name.substr(kSeries.size()));
  if (!name.starts_with("batch_")) return nullptr;
  return found_in(name.starts_with("batch_x") ? curve.batch_x_error : curve.batch_loss,
                  std::int64_t{std::stoi(name.substr(name.rfind('_') + 1))});
}

using Rows = std::vector<std::vector<Real>>;

// Distances of coordinates from the printed ones: the largest, or the mean.
Real deviation(const std::vector<PrintedRow>& rows, bool is_mean) {
  Real largest = 0, sum = 0, count = 0;
  for (const PrintedRow& row : rows)
    for (std::size_t j = 0; j < row.printed.size(); ++j, ++count) {
      const Real distance = std::abs(row.reached.at(j) - row.printed[j]);
      largest = std::max(largest, distance);
      sum += distance;
    }
  if (rows.empty()) return kUnknown;
  return is_mean ? sum / count : largest;
}

// How far y leaves the ray through its start: largest relative change of y2 / y1.
Real bend(const Rows& y, std::size_t row) {
  Real largest = 0;
  for (std::size_t i = 0; i <= row; ++i)
    largest = std::max(largest, std::abs(y[i].at(1) / y[i].at(0) * y[0][0] / y[0][1] - 1));
  return largest;
}

Real least_coordinate(const Rows& x, std::size_t row) {
  Real least = kNever;
  for (std::size_t i = 0; i <= row; ++i) least = std::min(least, std::ranges::min(x[i]));
  return least;
}

// For the first step: its component along the diagonal toward the origin, at most √2; or its angle
// with the straight way to 0, in degrees.
Real first_step(const Rows& path, bool is_angle) {
  const std::vector<Real>& from = path.at(0);
  const Real d1 = from.at(0) - path.at(1).at(0), d2 = from.at(1) - path.at(1).at(1);
  if (!is_angle) return (d1 + d2) / std::hypot(d1, d2);
  const Real cross = from[0] * d2 - from[1] * d1, dot = from[0] * d1 + from[1] * d2;
  return std::atan2(std::abs(cross), dot) * 180 / std::numbers::pi;
}

Real path_figure(const Record& record, const Place& place) {
  const auto& [x, y] = *record.trajectory;
  const std::string& column = place.column;
  const std::size_t row = index_at(record.curve, place);
  if (column.ends_with("deviation"))
    return deviation(printed_rows(record, place), column == "mean_deviation");
  if (column == "bend") return bend(y, row);
  if (column == "least_coordinate") return least_coordinate(x, row);
  if (column == "distance") return std::hypot(x.at(row).at(0), x.at(row).at(1));
  if (row == 0) return kUnknown;  // the others are of the step that led to the row
  if (column == "alignment") return first_step(x, false);
  if (column == "turn") return first_step(y, true);
  const Real before = x.at(row - 1).at(1), step = std::abs(x.at(row).at(1) - before);
  if (column == "step_2") return step;
  return column == "relative_step_2" ? step / std::abs(before) : kUnknown;
}

// How many times slower the logarithm of the error in x falls over the last third of the iterations
// up to the place than over the first; 1 of an exponential, infinite where it falls no more.
Real slowdown(const Curve& curve, std::size_t index) {
  const std::int64_t all = curve.iteration[index];
  const auto fall = [&](std::int64_t from, std::int64_t to) {
    const std::size_t i = point_at(curve.iteration, from), j = point_at(curve.iteration, to);
    const auto steps = static_cast<Real>(curve.iteration[j] - curve.iteration[i]);
    return std::log(curve.x_error.at(i) / curve.x_error.at(j)) / steps;
  };
  const Real first = fall(0, all / 3), last = fall(2 * all / 3, all);
  if (!(first > 0)) return kUnknown;
  return last > 0 ? first / last : kNever;
}

// The cost, in the unit of the place, when the column was first at most a bound; infinite if it
// never was.
Real spent_until(const Record& record, const Place& place) {
  const Curve& curve = record.curve;
  const auto& [name, bound] = bound_of(place.column);
  const std::vector<Real>* column = column_of(record, name);
  if (column == nullptr) return kUnknown;
  for (std::size_t i = 0; i <= index_at(curve, place); ++i) {
    if (!(value_at(*column, i) <= bound)) continue;
    if (place.seconds) return curve.processor_seconds.at(i);
    const bool is_work = place.work || place.column.starts_with(kWork);
    return static_cast<Real>(is_work ? curve.work.at(i) : curve.iteration[i]);
  }
  return kNever;
}

// −log₁₀ of the smallest relative loss gap (f − f_L)/s that is a target and was reached up to that
// iteration, at the best point that was evaluated; 0 where none was.
Real loss_digits(const Record& record, std::int64_t last) {
  if (!record.hits) return kUnknown;
  Real digits = 0;
  for (std::size_t i = 0; i < record.hits->target.size(); ++i)
    if (record.hits->iteration[i] >= 0 && record.hits->iteration[i] <= last)
      digits = std::max(digits, -std::log10(record.hits->target[i]));
  return digits;
}

}  // namespace

bool is_level(const std::string& column) {
  return column.starts_with(kUntil) || column.starts_with(std::string(kWork).append(kUntil));
}

std::pair<std::string, Real> bound_of(const std::string& column) {
  const std::size_t last = column.rfind(' ');
  const std::size_t first = column.find(kUntil) + kUntil.size();
  return {column.substr(first, last - first), std::stod(column.substr(last))};
}

std::vector<PrintedRow> printed_rows(const Record& record, const Place& place) {
  const Rows& path =
      place.column == "output_deviation" ? record.trajectory->y : record.trajectory->x;
  const std::size_t row = index_at(record.curve, place), count = place.table.size();
  const std::size_t first = count == 1 ? row : 1;
  const bool stands = row == 0;  // what has made no step stays at its start
  std::vector<PrintedRow> rows;
  if (!stands && first + count > path.size()) return rows;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = stands ? 0 : first + i;
    rows.push_back({record.curve.iteration.at(at), place.table[i], path.at(at)});
  }
  return rows;
}

std::size_t index_at(const Curve& curve, const Place& place) {
  if (place.iteration) return point_at(curve.iteration, *place.iteration);
  if (place.seconds) return point_at(curve.processor_seconds, *place.seconds);
  if (place.work) return point_at(curve.work, *place.work);
  return curve.iteration.size() - 1;
}

Real figure_of(const Record& record, const Place& place) {
  const Curve& curve = record.curve;
  const std::string& name = place.column;
  if (name == "milliseconds")
    return record.summary.iterations == 0
               ? kUnknown
               : 1e3 * record.summary.wall_seconds / static_cast<Real>(record.summary.iterations);
  if (curve.iteration.empty()) return kUnknown;
  const std::size_t index = index_at(curve, place);
  if (name == "loss_peak") return std::ranges::max(curve.loss | std::views::take(index + 1));
  if (name == "loss_drop") return curve.loss[0] - curve.loss[index];
  if (name == "slowdown") return slowdown(curve, index);
  if (name == "loss_digits") return loss_digits(record, curve.iteration[index]);
  if (name == "digits")
    return record.x_scale ? log_relative_error(curve.x_error.at(index) / *record.x_scale)
                          : kUnknown;
  if (is_level(name)) return spent_until(record, place);
  if (const auto* column = column_of(record, name)) {
    if (column->empty()) return kUnknown;
    const Real value = value_at(*column, index);
    const bool is_lost = std::isnan(value) && name.find("gradient") == std::string::npos;
    return is_lost && !name.starts_with(kSeries) ? kNever : value;  // it diverged
  }
  return record.trajectory ? path_figure(record, place) : kUnknown;
}

std::string column_words(const std::string& column) {
  if (column.starts_with(kSeries)) return column.substr(kSeries.size());
  if (is_level(column)) {
    const auto& [name, bound] = bound_of(column);
    return words("column.until", column_words(name), bound);
  }
  const std::string key = "column." + column;
  return all_sentences().contains(key) ? words(key) : column;
}

namespace {

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

// The alternative whose value counts, by value(its figures).
template <class Value>
Chosen best_alternative(const Term& term, Value value) {
  std::optional<Chosen> chosen;
  for (std::size_t i = 0; i < term.figures.size(); ++i) {
    const Real found = value(term.figures[i]);
    if (!chosen || (term.is_worst ? found > chosen->level : found < chosen->level))
      chosen = {i, found};
  }
  return chosen.value_or(Chosen{0, kNever});
}

Chosen chosen_of(const Term& term, const Places& seeds) {
  return best_alternative(term, [&](const std::vector<Real>& figures) {
    std::vector<Real> values;
    for (const std::size_t seed : seeds) values.push_back(figures.at(seed));
    const bool is_absent = std::ranges::all_of(values, [](Real v) { return std::isnan(v); });
    return is_absent ? kUnknown : term.scale * median_of(std::move(values));
  });
}

// The seeds of the alternative that counts, whose values reach the term's abscissa.
Real share(const Term& term, const Places& seeds) {
  if (std::ranges::any_of(term.figures,
                          [&](const auto& one) { return std::isnan(one.at(seeds[0])); }))
    return kUnknown;
  return best_alternative(term,
                          [&](const std::vector<Real>& figures) {
                            const auto reach = std::ranges::count_if(seeds, [&](std::size_t seed) {
                              return figures.at(seed) >= term.at;
                            });
                            return static_cast<Real>(reach) / static_cast<Real>(seeds.size());
                          })
      .level;
}

Places all_seeds(const Term& term) {
  Places seeds(term.figures.at(0).size());
  std::iota(seeds.begin(), seeds.end(), 0);
  return seeds;
}

// The mean of the first term less that of the second.
Real mean_difference(const std::vector<Term>& terms, const Places& seeds) {
  Real sum = 0;
  for (const std::size_t seed : seeds)
    sum += terms.at(0).figures.at(0).at(seed) - terms.at(1).figures.at(0).at(seed);
  return sum / static_cast<Real>(seeds.size());
}

Real quantity_over(const std::string& kind, const std::vector<Term>& terms, const Places& seeds) {
  if (kind == "share") return share(terms.at(0), seeds);
  if (kind == "mean_difference") return mean_difference(terms, seeds);
  std::vector<Real> medians, at;
  for (const Term& term : terms) {
    medians.push_back(chosen_of(term, seeds).level);
    if (std::isnan(medians.back())) return kUnknown;
    at.push_back(term.at);
  }
  return quantity_of(kind, medians, at);
}

}  // namespace

Chosen chosen_of(const Term& term) { return chosen_of(term, all_seeds(term)); }

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
  if (kind == "order" || kind == "trend" || kind == "mean_difference" || kind.ends_with("slope"))
    return 0;
  return std::nullopt;
}

namespace {

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
  Measurement out{.low = kUnknown, .high = kUnknown, .n = terms.at(0).figures.at(0).size()};
  const Places seeds = all_seeds(terms[0]);
  out.value = quantity_over(kind, terms, seeds);
  std::vector<Real> values;  // the quantity of each seed by itself
  for (const std::size_t seed : seeds) values.push_back(quantity_over(kind, terms, {seed}));
  std::erase_if(values, [](Real value) { return std::isnan(value); });
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

namespace {

Agreement around(Real value, const Json& claim) {
  const Json &tolerance = claim.at("tolerance"), &quantity = claim.at("quantity");
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
  if (quantity.at("kind") == "slope") {  // its two ends were each read with relative error t
    Real least = kNever, most = 0;
    for (const Json& term : quantity.at("terms")) {
      least = std::min(least, term.at("at").get<Real>());
      most = std::max(most, term.at("at").get<Real>());
    }
    const Real error = std::log((1 + t) / (1 - t)) / std::log(most / least);
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

// The effect of a value as a share of what was published, in what adds up: logarithms of ratios.
bool is_of_its_order(Real value, const Json& claim) {
  constexpr Real kFewestThirds = 1.0 / 3, kMostThirds = 3;
  const Json& published = claim.at("published");
  const bool is_ratio = claim.at("quantity").at("kind") == "ratio";
  const auto effect = [=](Real of) { return is_ratio ? std::log(of) : of; };
  const Real share = effect(value) / effect(published_value(published));
  return share >= kFewestThirds && (!published.contains("value") || share <= kMostThirds);
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
  const std::string better = claim.at("published").value("better", "");  // further than the band
  if (better == "less" ? high < band.low : better == "greater" && low > band.high)
    return Verdict::stronger;
  const bool is_partly = side != 0 && is_all_on_side && is_of_its_order(measured.value, claim);
  return is_partly ? Verdict::partly : Verdict::not_reproduced;
}

}  // namespace

Real published_value(const Json& published) {
  for (const char* key : {"value", "at_least", "at_most"})
    if (published.contains(key)) return real_of(published[key]);
  return 0;  // a table: no distance from it
}

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
