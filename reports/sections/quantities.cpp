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
#include "core/results/contrasts.h"
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
// up to the place than over the first; 1 of an exponential, infinite where it falls no more. Ends
// are means of the logarithm over a sixth of the iterations: single points vary more than they
// fall.
Real slowdown(const Curve& curve, std::size_t index) {
  const std::int64_t all = curve.iteration[index];
  constexpr std::int64_t kSixths = 6;
  const auto level = [&](std::int64_t sixth) {
    Real sum = 0, weight = 0;
    const std::int64_t from = all * sixth / kSixths, to = all * (sixth + 1) / kSixths;
    for (std::size_t i = 0; i + 1 < curve.iteration.size() && i < index; ++i) {
      const std::int64_t begin = std::max(curve.iteration[i], from),
                         end = std::min(curve.iteration[i + 1], to);
      if (end <= begin) continue;
      const auto steps = static_cast<Real>(end - begin);
      sum += steps * (std::log(curve.x_error.at(i)) + std::log(curve.x_error.at(i + 1))) / 2;
      weight += steps;
    }
    return sum / weight;
  };
  const Real first = level(0) - level(1), last = level(kSixths - 2) - level(kSixths - 1);
  if (!(first > 0)) return kUnknown;
  return last > 0 ? first / last : kNever;
}

// The share of steps that raised the loss, of those up to the place between kept iterations.
Real rises(const Curve& curve, std::size_t index) {
  Real raised = 0;
  for (std::size_t i = 1; i <= index; ++i) raised += curve.loss[i] > curve.loss[i - 1] ? 1 : 0;
  return index > 0 ? raised / static_cast<Real>(index) : kUnknown;
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
  const bool has_steps = record.summary.iterations > 0 && place.iteration != 0;
  if (name == "milliseconds")
    return has_steps ? 1e3 * record.summary.processor_seconds /
                           static_cast<Real>(record.summary.iterations)
                     : kUnknown;
  if (name == "peak_memory")
    return has_steps ? 1e-6 * static_cast<Real>(record.summary.peak_memory_bytes) : kUnknown;
  if (curve.iteration.empty()) return kUnknown;
  const std::size_t index = index_at(curve, place);
  if (name == "loss_peak") return std::ranges::max(curve.loss | std::views::take(index + 1));
  if (name == "loss_drop") return curve.loss[0] - curve.loss[index];
  if (name == "slowdown") return slowdown(curve, index);
  if (name == "rises") return rises(curve, index);
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
  for (const std::size_t seed : seeds) out.each.push_back(quantity_over(kind, terms, {seed}));
  std::erase_if(out.each, [](Real value) { return std::isnan(value); });
  std::vector<Real> values = out.each;
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

bool is_threshold(const Json& claim) {
  const Json& published = claim.at("published");
  return published.contains("at_least") || published.contains("at_most");
}

// The kinds that are counted, seed by seed.
bool is_counted(const std::string& kind) {
  return kind == "position" || kind == "order" || kind == "trend";
}

// The scale on which runs are normal: logarithms, or of a slope the change of the logarithm over
// its abscissas, so that ln 2 is a factor of two on either; all else as it is.
struct Scale {
  bool is_log = false;
  Real factor = 0;  // of slopes; 0: neither

  Real operator()(Real value) const {
    return is_log ? std::log(value) : factor > 0 ? factor * value : value;
  }
  bool tells_factors() const { return is_log || factor > 0; }
};
Scale scale_of(const std::vector<Real>& each, const Json& claim) {
  const std::string kind = claim.at("quantity").at("kind");
  if (kind.ends_with("slope")) {
    Real least = kNever, most = 0;
    for (const Json& term : claim["quantity"].at("terms")) {
      least = std::min(least, term.value("at", 1.0));
      most = std::max(most, term.value("at", 1.0));
    }
    return {.factor = most > least ? std::log(most / least) : 0};
  }
  const bool is_positive = std::ranges::all_of(each, [](Real value) { return value > 0; });
  return {.is_log = kind != "mean_difference" && kind != "share" && !is_counted(kind) &&
                    is_positive && published_value(claim.at("published")) > 0};
}

// The values on their scale; nothing where one is not finite there.
std::optional<std::vector<Real>> scaled_values(const Measurement& measured, const Scale& scale) {
  std::vector<Real> values;
  for (const Real value : measured.each.empty() ? std::vector{measured.value} : measured.each) {
    values.push_back(scale(value));
    if (!std::isfinite(values.back())) return std::nullopt;
  }
  return values;
}

// Whether the share of successes lies above q, by its exact one-sided bound, or below it.
constexpr Real kOneSided = 0.05;
Verdict verdict_on_share(std::size_t successes, std::size_t n, Real q) {
  if (binomial_tail(successes, n, q) <= kOneSided) return Verdict::agrees;
  if (1 - binomial_tail(successes + 1, n, q) <= kOneSided) return Verdict::differs;
  return Verdict::too_noisy;
}

Real mean_of(const std::vector<Real>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<Real>(values.size());
}

// The spread of the runs: their own, or that of shorter ones.
struct RunSpread {
  Real deviation = 0;
  std::size_t freedom = 0;  // 0: unknown
};
RunSpread spread_of_runs(const Measurement& measured, const std::vector<Real>& values) {
  if (values.size() > 1) return {deviation_of(values), values.size() - 1};
  if (measured.shorter_runs > 1) return {measured.deviation_of_shorter, measured.shorter_runs - 1};
  return {};
}

Verdict verdict_on_value(const std::vector<Real>& values, const RunSpread& spread,
                         const Scale& scale, const Json& claim) {
  constexpr Real kLeast = 1.1, kFactor = 2, kTwoSided = 0.975;
  const Real published = published_value(claim.at("published"));
  const Agreement band = around(published, claim);
  Real width = (scale(band.high) - scale(std::max(band.low, scale.is_log ? 1e-300 : band.low))) / 2;
  if (scale.tells_factors()) width = std::max(width, std::log(kLeast));
  const Real n = static_cast<Real>(values.size());
  const Real error = spread.freedom == 0 ? 0
                                         : student_quantile(kTwoSided, spread.freedom) *
                                               spread.deviation * std::sqrt(1 + 1 / n);
  if (std::abs(scale(published) - mean_of(values)) > std::hypot(error, width))
    return Verdict::differs;
  const Real effect = std::abs(published - neutral_of(claim).value_or(0));
  const Real most = scale.tells_factors() || effect == 0 ? std::log(kFactor) : effect / kFactor;
  return error > most ? Verdict::too_noisy : Verdict::agrees;
}

Verdict verdict_on_threshold(const std::vector<Real>& values, const RunSpread& spread,
                             const Scale& scale, const Json& claim) {
  const Agreement band = agreement_of(claim);
  const bool is_least = band.low > -kNever;
  const Real sign = is_least ? 1 : -1, bound = is_least ? band.low : band.high;
  const bool is_open = is_least ? band.is_low_open : band.is_high_open;
  const Real half = spread.freedom == 0
                        ? 0
                        : student_quantile(1 - kOneSided, spread.freedom) * spread.deviation /
                              std::sqrt(static_cast<Real>(values.size()));
  const Real beyond = sign * (mean_of(values) - scale(bound));
  if (is_open ? beyond - half > 0 : beyond - half >= 0) return Verdict::agrees;
  return beyond + half < 0 || (is_open && beyond + half <= 0) ? Verdict::differs
                                                              : Verdict::too_noisy;
}

Verdict verdict_on_runs(const Measurement& measured, const Json& claim, bool is_drawn) {
  const std::string kind = claim.at("quantity").at("kind");
  const Agreement band = agreement_of(claim);
  const auto by_band = [&] {
    return band.holds(measured.value) ? Verdict::agrees : Verdict::differs;
  };
  const bool is_printed = claim.at("tolerance").contains("absolute");
  if (!is_drawn && (is_printed || is_threshold(claim) || is_counted(kind))) return by_band();
  const auto n = std::max<std::size_t>(measured.n, 1);
  if (is_drawn && n < 2 && measured.shorter_runs == 0) return Verdict::one_run;
  if (kind == "share")
    return verdict_on_share(static_cast<std::size_t>(std::llround(measured.value * Real(n))), n,
                            std::clamp(band.low, 0.0, 1.0));
  const Scale scale = scale_of(measured.each, claim);
  const auto values = scaled_values(measured, scale);
  const bool has_bound =
      !is_threshold(claim) || std::isfinite(scale(band.low > -kNever ? band.low : band.high));
  if (is_counted(kind) || !values || !has_bound) {
    const auto with = std::ranges::count_if(measured.each, [&](Real v) { return band.holds(v); });
    return is_drawn ? verdict_on_share(static_cast<std::size_t>(with), measured.each.size(), 0.5)
                    : by_band();
  }
  const RunSpread spread = is_drawn ? spread_of_runs(measured, *values) : RunSpread{};
  return is_threshold(claim) ? verdict_on_threshold(*values, spread, scale, claim)
                             : verdict_on_value(*values, spread, scale, claim);
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
  const Verdict verdict = verdict_on_runs(measured, claim, is_drawn);
  const bool is_enough = !is_drawn || measured.n >= kFewestForInterval;
  return verdict == Verdict::agrees && is_enough ? Verdict::reproduced : verdict;
}

std::optional<Real> deviation_of_runs(const Measurement& measured, const Json& claim) {
  const auto values = scaled_values(measured, scale_of(measured.each, claim));
  return values && values->size() > 1 ? std::optional(deviation_of(*values)) : std::nullopt;
}

std::optional<Direction> direction_of(const Measurement& measured, const Json& claim) {
  const int side = side_of(claim);
  const auto neutral = neutral_of(claim);
  if (side == 0 || !neutral || measured.each.size() < 2) return std::nullopt;
  Direction out;
  std::size_t against = 0;
  for (const Real value : measured.each) {
    out.with += side * (value - *neutral) > 0;
    against += side * (value - *neutral) < 0;
  }
  out.seeds = measured.each.size();
  if (const std::size_t told = out.with + against; told > 0)
    out.p = std::min(1.0, 2 * binomial_tail(std::max(out.with, against), told, 0.5));
  return out;
}

}  // namespace isoline::reports
