// Reads figures off records: columns of their curves, and what their paths come to.
#include "reports/sections/run_figures.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <ranges>

#include "reports/statistics/statistics.h"

namespace isoline::reports {
namespace {

constexpr Real kAbsent = std::numeric_limits<Real>::quiet_NaN();

// Running means begin with the first step: before it, what that saw.
Real value_at(const std::vector<Real>& column, std::size_t index) {
  const bool is_before_any = index == 0 && std::isnan(column[0]) && column.size() > 1;
  return column.at(is_before_any ? 1 : index);
}

constexpr std::string_view kSeries = "series: ";

const std::vector<Real>* column_of(const Record& record, const std::string& name) {
  static const std::map<std::string, std::vector<Real> Curve::*> plain = {
      {"x_error", &Curve::x_error},
      {"loss", &Curve::loss},
      {"gradient_norm", &Curve::gradient_norm},
      {"step_norm", &Curve::step_norm}};
  const Curve& curve = record.curve;
  if (const auto found = plain.find(name); found != plain.end()) return &(curve.*found->second);
  if (name.starts_with(kSeries)) {
    const auto found = record.series.find(name.substr(kSeries.size()));
    return found == record.series.end() ? nullptr : &found->second;
  }
  const std::size_t digits = name.rfind('_') + 1;
  std::int64_t length = 0;
  if (!name.starts_with("batch_") ||
      std::from_chars(name.data() + digits, name.data() + name.size(), length).ec != std::errc())
    return nullptr;
  const auto& windows = name.starts_with("batch_x") ? curve.batch_x_error : curve.batch_loss;
  const auto window = windows.find(length);
  return window != windows.end() ? &window->second : nullptr;
}

using Path = std::vector<std::vector<Real>>;

// Distances of coordinates from the printed ones: the largest and the mean.
struct Deviation {
  Real largest = 0, mean = 0;
};
Deviation deviation(const std::vector<PrintedRow>& rows) {
  if (rows.empty()) return {kAbsent, kAbsent};
  Deviation found;
  Real count = 0;
  for (const PrintedRow& row : rows)
    for (std::size_t j = 0; j < row.printed.size(); ++j, ++count) {
      const Real distance = std::abs(row.reached.at(j) - row.printed[j]);
      found.largest = std::max(found.largest, distance);
      found.mean += distance;
    }
  found.mean /= count;
  return found;
}

// How far y leaves the ray through its start: largest relative change of y2 / y1.
Real bend(const Path& y, std::size_t row) {
  Real largest = 0;
  for (std::size_t i = 0; i <= row; ++i)
    largest = std::max(largest, std::abs(y[i].at(1) / y[i].at(0) * y[0][0] / y[0][1] - 1));
  return largest;
}

// Of the first update with the diagonal toward the origin; √2 at most.
Real alignment(const Path& x) {
  const Real d1 = x.at(0).at(0) - x.at(1).at(0), d2 = x.at(0).at(1) - x.at(1).at(1);
  return (d1 + d2) / std::hypot(d1, d2);
}

// Between the first step in y and the straight way to y* = 0, in degrees.
Real turn(const Path& y) {
  const Real d1 = y.at(0).at(0) - y.at(1).at(0), d2 = y.at(0).at(1) - y.at(1).at(1);
  const Real cross = y[0][0] * d2 - y[0][1] * d1, dot = y[0][0] * d1 + y[0][1] * d2;
  return std::atan2(std::abs(cross), dot) * 180 / std::numbers::pi;
}

Real least_coordinate(const Path& x, std::size_t row) {
  Real least = kNever;
  for (std::size_t i = 0; i <= row; ++i) least = std::min(least, std::ranges::min(x[i]));
  return least;
}

// Of the step that led to the row.
Real step_figure(const std::string& column, const Trajectory& path, std::size_t row) {
  if (row == 0) return kAbsent;
  if (column == "alignment") return alignment(path.x);
  if (column == "turn") return turn(path.y);
  const Real before = path.x.at(row - 1).at(1), step = std::abs(path.x.at(row).at(1) - before);
  if (column == "step_2") return step;
  return column == "relative_step_2" ? step / std::abs(before) : kAbsent;
}

Real path_figure(const Record& record, const Place& place) {
  const auto& [x, y] = *record.trajectory;
  const std::size_t row = index_at(record.curve, place);
  if (place.column == "mean_deviation") return deviation(printed_rows(record, place)).mean;
  if (place.column.ends_with("deviation")) return deviation(printed_rows(record, place)).largest;
  if (place.column == "bend") return bend(y, row);
  if (place.column == "least_coordinate") return least_coordinate(x, row);
  if (place.column == "distance") return std::hypot(x.at(row).at(0), x.at(row).at(1));
  return step_figure(place.column, *record.trajectory, row);
}

// How many times slower the logarithm of the error in x falls over the last third of the iterations
// up to the place than over the first; 1 of an exponential, infinite where it falls no more.
Real slowdown(const Curve& curve, std::size_t index) {
  const std::int64_t all = curve.iteration[index];
  const auto fall = [&](std::int64_t from, std::int64_t to) {
    const std::size_t i = index_at(curve, {.column = "", .iteration = from});
    const std::size_t j = index_at(curve, {.column = "", .iteration = to});
    const auto steps = static_cast<Real>(curve.iteration[j] - curve.iteration[i]);
    return std::log(curve.x_error.at(i) / curve.x_error.at(j)) / steps;
  };
  const Real first = fall(0, all / 3), last = fall(2 * all / 3, all);
  if (!(first > 0)) return kAbsent;
  return last > 0 ? first / last : kNever;
}

}  // namespace

std::vector<PrintedRow> printed_rows(const Record& record, const Place& place) {
  const Path& path =
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
  const auto last = [](const auto& column, const auto& at) {
    const std::ptrdiff_t passed = std::ranges::upper_bound(column, at) - column.begin();
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, passed) - 1);
  };
  if (place.iteration) return last(curve.iteration, *place.iteration);
  if (place.seconds) return last(curve.processor_seconds, *place.seconds);
  return curve.iteration.size() - 1;
}

Real figure_of(const Record& record, const Place& place) {
  if (place.column == "milliseconds")
    return record.summary.iterations == 0
               ? kAbsent
               : 1e3 * record.summary.wall_seconds / static_cast<Real>(record.summary.iterations);
  if (record.curve.iteration.empty()) return kAbsent;
  const std::size_t index = index_at(record.curve, place);
  if (place.column == "loss_peak")
    return std::ranges::max(record.curve.loss | std::views::take(index + 1));
  if (place.column == "loss_drop") return record.curve.loss[0] - record.curve.loss[index];
  if (place.column == "slowdown") return slowdown(record.curve, index);
  if (const auto* column = column_of(record, place.column)) {
    if (column->empty()) return kAbsent;
    const Real value = value_at(*column, index);
    const bool is_lost = std::isnan(value) && place.column.find("gradient") == std::string::npos;
    return is_lost && !place.column.starts_with(kSeries) ? kNever : value;  // it diverged
  }
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
      {"loss_drop", "fall of the loss since the start"},
      {"slowdown", "slowing of the error in x, first third over last third"},
      {"gradient_norm", "length of the gradient"},
      {"step_norm", "length of the step"},
      {"step_2", "length of the step in the second coordinate"},
      {"relative_step_2", "step in the second coordinate as a share of it"},
      {"least_coordinate", "least coordinate of the path"},
      {"deviation", "largest distance of x from the printed figures"},
      {"output_deviation", "largest distance of y from the printed figures"},
      {"mean_deviation", "mean distance of x from the printed figures"},
      {"turn", "angle of the first step in y with the straight way, in degrees,"},
      {"bend", "largest relative change of y2 / y1"},
      {"alignment", "first update's component along the diagonal"},
      {"distance", "distance to the origin"},
      {"milliseconds", "milliseconds an iteration"}};
  if (column.starts_with(kSeries)) return column.substr(kSeries.size());
  const auto found = words.find(column);
  return found == words.end() ? column : found->second;
}

}  // namespace isoline::reports
