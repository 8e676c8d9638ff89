// Reads figures off records, combines their medians, and resamples seeds.
#include "reports/sections/quantities.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "reports/statistics/resampling.h"

namespace isoline::reports {
namespace {

constexpr Real kAbsent = std::numeric_limits<Real>::quiet_NaN();

// The last kept point at or before the place.
std::size_t index_at(const Curve& curve, const Place& place) {
  const auto last = [](const auto& column, const auto& at) {
    const std::ptrdiff_t passed = std::ranges::upper_bound(column, at) - column.begin();
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, passed) - 1);
  };
  if (place.iteration) return last(curve.iteration, *place.iteration);
  if (place.seconds) return last(curve.processor_seconds, *place.seconds);
  return curve.iteration.size() - 1;
}

// Running means begin with the first step: before it, what that saw.
Real value_at(const std::vector<Real>& column, std::size_t index) {
  if (column.empty()) return kAbsent;
  const bool is_before_any = index == 0 && std::isnan(column[0]) && column.size() > 1;
  return column.at(is_before_any ? 1 : index);
}

constexpr std::string_view kSeries = "series: ";

const std::vector<Real>* column_of(const Record& record, const std::string& name) {
  static const std::map<std::string, std::vector<Real> Curve::*> plain = {
      {"x_error", &Curve::x_error},
      {"loss", &Curve::loss},
      {"gradient_norm", &Curve::gradient_norm}};
  const Curve& curve = record.curve;
  if (const auto found = plain.find(name); found != plain.end()) return &(curve.*found->second);
  if (name.starts_with(kSeries)) {
    const auto found = record.series.find(name.substr(kSeries.size()));
    return found == record.series.end() ? nullptr : &found->second;
  }
  const std::size_t end = name.rfind('_');
  const auto& windows = name.starts_with("batch_x") ? curve.batch_x_error : curve.batch_loss;
  const auto window = windows.find(std::atoll(name.c_str() + end + 1));
  return name.starts_with("batch_") && window != windows.end() ? &window->second : nullptr;
}

// Largest distance of any coordinate from the printed one.
Real deviation(const std::vector<PrintedRow>& rows) {
  if (rows.empty()) return kAbsent;
  Real largest = 0;
  for (const PrintedRow& row : rows)
    for (std::size_t j = 0; j < row.printed.size(); ++j)
      largest = std::max(largest, std::abs(row.reached.at(j) - row.printed[j]));
  return largest;
}

// How far y leaves the ray through its start: largest relative change of y2 / y1.
Real bend(const std::vector<std::vector<Real>>& y) {
  Real largest = 0;
  for (const auto& at : y)
    largest = std::max(largest, std::abs(at.at(1) / at.at(0) * y[0][0] / y[0][1] - 1));
  return largest;
}

// Of the first update with the diagonal toward the origin; √2 at most.
Real alignment(const std::vector<std::vector<Real>>& x) {
  const Real d1 = x.at(0).at(0) - x.at(1).at(0), d2 = x.at(0).at(1) - x.at(1).at(1);
  return (d1 + d2) / std::hypot(d1, d2);
}

Real path_figure(const Record& record, const Place& place) {
  const auto& x = record.trajectory->x;
  const std::size_t row = index_at(record.curve, place);
  const auto& at = x.at(row);
  if (place.column.ends_with("deviation")) return deviation(printed_rows(record, place));
  if (place.column == "bend") return bend(record.trajectory->y);
  if (place.column == "alignment") return x.size() < 2 ? kAbsent : alignment(x);
  if (place.column == "distance") return std::hypot(at.at(0), at.at(1));
  return kAbsent;
}

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

// Pairs in the order of the terms, less those against it, over all of them.
Real order(const std::vector<Real>& m) {
  Real with = 0, pairs = 0;
  for (std::size_t i = 0; i < m.size(); ++i)
    for (std::size_t j = i + 1; j < m.size(); ++j, ++pairs)
      with += m[i] < m[j] ? 1 : m[i] > m[j] ? -1 : 0;
  return with / pairs;
}

// Of the first, from 1; those equal to it share the places that they take.
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
    const Real median = term.scale * median_of(std::move(values));
    if (!chosen || (term.is_worst ? median > chosen->level : median < chosen->level))
      chosen = {i, median};
  }
  return chosen.value_or(Chosen{0, kNever});
}

Real quantity_over(const std::string& kind, const std::vector<Term>& terms,
                   const std::vector<std::size_t>& seeds) {
  std::vector<Real> medians, at;
  for (const Term& term : terms) {
    medians.push_back(chosen_of(term, seeds).level);
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

std::vector<PrintedRow> printed_rows(const Record& record, const Place& place) {
  const auto& path =
      place.column == "output_deviation" ? record.trajectory->y : record.trajectory->x;
  const std::size_t first = place.table.size() == 1 ? index_at(record.curve, place) : 1;
  std::vector<PrintedRow> rows;
  if (first + place.table.size() > path.size()) return rows;
  for (std::size_t i = 0; i < place.table.size(); ++i)
    rows.push_back({record.curve.iteration.at(first + i), place.table[i], path[first + i]});
  return rows;
}

Real figure_of(const Record& record, const Place& place) {
  if (place.column == "milliseconds")
    return record.summary.iterations == 0
               ? kAbsent
               : 1e3 * record.summary.wall_seconds / static_cast<Real>(record.summary.iterations);
  if (record.curve.iteration.empty()) return kAbsent;
  const std::size_t index = index_at(record.curve, place);
  if (place.column == "loss_peak")
    return *std::max_element(record.curve.loss.begin(), record.curve.loss.begin() + index + 1);
  if (const auto* column = column_of(record, place.column)) return value_at(*column, index);
  return record.trajectory ? path_figure(record, place) : kAbsent;
}

std::string column_words(const std::string& column) {
  static const std::map<std::string, std::string> words = {
      {"x_error", "error in x on the validation"},
      {"loss", "loss on the validation"},
      {"batch_x_error_64", "error in x, running mean over 64 steps"},
      {"batch_x_error_256", "error in x, running mean over 256 steps"},
      {"batch_loss_64", "loss, running mean over 64 steps"},
      {"batch_loss_256", "loss, running mean over 256 steps"},
      {"loss_peak", "greatest loss on the validation"},
      {"gradient_norm", "length of the gradient"},
      {"deviation", "largest distance of x from the printed figures"},
      {"output_deviation", "largest distance of y from the printed figures"},
      {"bend", "largest relative change of y2 / y1"},
      {"alignment", "first update's component along the diagonal"},
      {"distance", "distance to the origin"},
      {"milliseconds", "milliseconds an iteration"}};
  if (column.starts_with(kSeries)) return column.substr(kSeries.size());
  const auto found = words.find(column);
  return found == words.end() ? column : found->second;
}

Real quantity_of(const std::string& kind, const std::vector<Real>& medians,
                 const std::vector<Real>& at) {
  const Real first = medians.at(0);
  if (kind == "ratio") return first / medians.at(1);
  if (kind == "slope") return slope(medians, at);
  if (kind == "crossing") return crossing(medians, at);
  if (kind == "order") return order(medians);
  if (kind == "greatest") return std::ranges::max(medians);
  if (kind == "position") return position(medians);
  return first;
}

std::optional<Real> neutral_of(const std::string& kind) {
  if (kind == "ratio") return 1;
  if (kind == "slope" || kind == "order") return 0;
  return std::nullopt;
}

namespace {

// Too few seeds for an interval: what each of them alone gives, from the least to the greatest.
Measurement with_range(Measurement out, const std::string& kind, const std::vector<Term>& terms) {
  std::vector<Real> values;
  for (std::size_t seed = 0; seed < out.n; ++seed)
    if (const Real value = quantity_over(kind, terms, {seed}); !std::isnan(value))
      values.push_back(value);
  if (values.empty()) return out;
  out.low = std::ranges::min(values);
  out.high = std::ranges::max(values);
  return out;
}

}  // namespace

Measurement measure(const std::string& kind, const std::vector<Term>& terms,
                    const std::string& stream) {
  Measurement out{.low = kAbsent, .high = kAbsent, .n = terms.at(0).figures.at(0).size()};
  Places seeds(out.n);
  std::iota(seeds.begin(), seeds.end(), 0);
  out.value = quantity_over(kind, terms, seeds);
  if (out.n < 2) return out;
  if (out.n < kFewestForInterval) return with_range(out, kind, terms);
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

}  // namespace isoline::reports
