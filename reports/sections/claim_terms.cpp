// Reads figures off records, columns of their curves and what their paths come to, and says what
// they are.
#include "reports/sections/claim_terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ranges>

#include "core/json.h"
#include "reports/read/ranking.h"
#include "reports/sections/words.h"
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

// Words for the yardstick.

std::string tau_name(const Comparison& c) { return std::string(c.yardstick.tightest().name); }

std::string_view counted_name(Measure by) {
  constexpr std::array<std::string_view, kMeasures.size()> kNames = {
      "declared work", "cost at measured prices", "iterations", "wall time"};
  return kNames[static_cast<std::size_t>(by)];
}
std::string_view counted_name(const Comparison& c) { return counted_name(c.yardstick.by); }

std::string_view unit_name(Measure by) {
  constexpr std::array<std::string_view, kMeasures.size()> kNames = {
      "forward solves", "equivalent forward solves", "iterations", "ms"};
  return kNames[static_cast<std::size_t>(by)];
}
std::string_view unit_name(const Comparison& c) { return unit_name(c.yardstick.by); }

std::string counted_to_tau(const Comparison& c) {
  const std::string text = fmt::format("{} to {}", counted_name(c), tau_name(c));
  return counted_name(c) == unit_name(c) ? text : fmt::format("{}, in {}", text, unit_name(c));
}

std::string amount(Measure by, Real value) {
  return by == Measure::time ? milliseconds(value) : reached_figure(value);
}
std::string amount(const Comparison& c, Real value) { return amount(c.yardstick.by, value); }

std::string_view time_mark(const Comparison& c, const Cell& cell) {
  return c.yardstick.by == Measure::time && !cell.is_timed_alone ? "≈" : "";
}

std::string_view setting_noun(const Comparison& c) {
  return c.problems.size() > c.names ? "setting" : "problem";
}

std::string_view common_noun(const Comparison& c) {
  return names_of(c, c.order) == c.order.settings.size() ? "problem" : "setting";
}

std::string n_column(const Comparison& c) { return fmt::format("n {}s", setting_noun(c)); }

std::string counted_settings(const Comparison& c, std::size_t count) {
  return counted(count, setting_noun(c));
}

std::string success_text(const Comparison& c) {
  const std::string tau = tau_name(c);
  const auto aims_at_x = static_cast<std::size_t>(std::ranges::count_if(
      c.problems, [](const ProblemAxis& problem) { return problem.aim == Aim::x; }));
  const std::string loss = fmt::format("the relative loss gap is at most {}", tau);
  const std::string x = fmt::format("the error in x is at most {} of the solution’s norm", tau);
  if (aims_at_x == 0) return fmt::format("Solved to {}: {}.", tau, loss);
  if (aims_at_x == c.problems.size()) return fmt::format("Solved to {}: {}.", tau, x);
  return fmt::format("Solved to {}: {}; on the {} whose user wants x, {} instead.", tau, loss,
                     counted_settings(c, aims_at_x), x);
}

// Finds the runs of a claim's terms and reads their figures.

using Json = nlohmann::json;
namespace {

constexpr std::array<const char*, 2> kTermLists = {"terms", "contrast_terms"};

}  // namespace

std::vector<std::string> cells_of(const Json& set) {
  std::vector<std::string> cells;
  for (const char* list : kTermLists)
    for (const Json& term : set.value(list, Json::array()))
      for (const Json& alternative : term)
        for (const Json& cell : alternative.at("cells")) cells.push_back(cell);
  return cells;
}

std::vector<std::string> missing_cells(const Json& set, const ByCell& runs) {
  std::vector<std::string> missing;
  const auto look = [&](const Json& alternative) {
    const auto title = alternative.at("title").get<std::string>();
    for (const Json& cell : alternative.at("cells")) {
      const bool is_known = runs.contains(cell.get<std::string>());
      if (!is_known && std::ranges::find(missing, title) == missing.end()) missing.push_back(title);
    }
  };
  for (const char* list : kTermLists)
    for (const Json& term : set.value(list, Json::array()))
      for (const Json& alternative : term) look(alternative);
  return missing;
}

Place place_of(const Json& claim, const Json& term) {
  const Json& quantity = claim.at("quantity");
  Place place;
  (term.contains("column") ? term : quantity).at("column").get_to(place.column);
  const Json& from = term.contains("iteration") ? term : quantity;
  if (from.contains("iteration")) place.iteration = from["iteration"].get<std::int64_t>();
  const Json& published = claim.at("published");
  if (published.contains("table")) published["table"].get_to(place.table);
  return place;
}

std::vector<Real> equal_seconds(const Json& cells, const ByCell& runs, std::int64_t iterations) {
  std::vector<Real> seconds;
  for (const Json& term : cells)
    for (const Json& alternative : term) {
      const Json& all = alternative.at("cells");
      seconds.resize(std::max(seconds.size(), all.size()), kNever);
      for (std::size_t seed = 0; seed < all.size(); ++seed) {
        const Summary& summary = runs.at(all[seed].get<std::string>())->summary;
        if (summary.iterations == 0) continue;
        const Real price = summary.processor_seconds / static_cast<Real>(summary.iterations);
        seconds[seed] = std::min(seconds[seed], price * static_cast<Real>(iterations));
      }
    }
  return seconds;
}

namespace {

// Each takes the figures of the first term of its problem that is read at its iteration.
void take_for_one(std::vector<Term>& terms, const Json& asked) {
  for (std::size_t i = 0; i < terms.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto same = [&](const char* key) {
        return asked.at(i).value(key, Json()) == asked.at(j).value(key, Json());
      };
      if (!same("problem") || !same("iteration") || !same("column")) continue;
      terms[i].figures = terms[j].figures;
      break;
    }
}

}  // namespace

std::vector<Term> terms_of(const Json& claim, const Json& cells, const ByCell& runs,
                           std::int64_t iterations, Null null) {
  const Json& quantity = claim.at("quantity");
  const bool is_by_time = quantity.value("clock", "") == "seconds";
  const std::vector<Real> seconds =
      is_by_time ? equal_seconds(cells, runs, iterations) : std::vector<Real>();
  std::vector<Term> terms;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Json& asked = quantity.at("terms").at(i);
    Place place = place_of(claim, asked);
    if (null == Null::untrained) place.iteration = 0;
    Term& term = terms.emplace_back(Term{.figures = {},
                                         .at = asked.value("at", 1.0),
                                         .scale = asked.value("scale", 1.0),
                                         .is_worst = asked.value("of", "best") == "worst"});
    for (const Json& alternative : cells[i]) {
      auto& values = term.figures.emplace_back();
      for (const Json& cell : alternative.at("cells")) {
        if (is_by_time && !place.iteration) place.seconds = seconds.at(values.size());
        values.push_back(figure_of(*runs.at(cell.get<std::string>()), place));
      }
    }
  }
  if (null == Null::twins) take_for_one(terms, quantity.at("terms"));
  return terms;
}

bool has_rivals(const Json& claim) {
  const Json& terms = claim.at("quantity").at("terms");
  for (const Json& one : terms)
    for (const Json& other : terms)
      if (one.value("problem", "") == other.value("problem", "") &&
          one.at("optimizer") != other.at("optimizer"))
        return true;
  return claim.contains("contrast") && has_rivals(claim.at("contrast"));
}

// Words for the figures of a claim.

namespace {

const char* words_of_source(const std::string& from) {
  if (from == "text") return "from text";
  return from == "digitized" ? "off a digitized curve" : "off a figure";
}

std::string tolerance_text(const Json& tolerance) {
  const std::string from = tolerance.at("from");
  const bool is_ratio = tolerance.value("values", 1) == 2;
  if (from == "none") return "no error stated";
  if (from == "digits")
    return fmt::format("±{} in its digits", figure(real_of(tolerance["absolute"])));
  const Real t = real_of(tolerance["relative"]);
  std::string of_one = fmt::format("±{:.0f} % {}", 100 * t, words_of_source(from));
  if (!is_ratio) return of_one;
  // The law of quantities.cpp for a ratio of two readings.
  return fmt::format("{}, each value: {:+.0f} to {:+.0f} %", of_one, 100 * ((1 - t) / (1 + t) - 1),
                     100 * ((1 + t) / (1 - t) - 1));
}

std::string iteration_text(const Json& from, const char* otherwise) {
  if (!from.contains("iteration")) return otherwise;
  return fmt::format("at iteration {}", from["iteration"].get<std::int64_t>());
}

std::string term_text(const Json& term) {
  const Json& optimizer = term.at("optimizer");
  std::string text = optimizer.is_array()
                         ? fmt::format("{} of {}", term.value("of", "best"), optimizer.size())
                         : shown_spec(optimizer.get<std::string>());
  if (term.contains("column")) text += " " + column_words(term["column"]);
  if (term.contains("iteration")) text += " " + iteration_text(term, "");
  if (term.contains("at")) text += fmt::format(" at {}", figure(real_of(term["at"])));
  return text;
}

}  // namespace

Real published_value(const Json& published) {
  for (const char* key : {"value", "at_least", "at_most"})
    if (published.contains(key)) return real_of(published[key]);
  return 0;  // a table: no distance from it
}

std::string published_text(const Json& claim) {
  const Json& published = claim.at("published");
  const std::string error = tolerance_text(claim.at("tolerance"));
  if (published.contains("table"))
    return published["table"].size() == 1
               ? fmt::format("an end point ({})", error)
               : fmt::format("{} rows of figures ({})", published["table"].size(), error);
  const char* relation = published.contains("at_least")  ? "≥ "
                         : published.contains("at_most") ? "≤ "
                                                         : "";
  return fmt::format("{}{} ({})", relation, figure(published_value(published)), error);
}

std::string source_text(const Json& source) {
  std::string text = source.at("paper");
  for (const char* part : {"section", "figure"})
    if (source.contains(part)) text += fmt::format(", {}", source[part].get<std::string>());
  return text;
}

std::string quantity_text(const Json& claim) {
  const Json& quantity = claim.at("quantity");
  const std::string kind = quantity.at("kind");
  std::vector<std::string> terms;
  for (const Json& term : quantity.at("terms")) {
    terms.push_back(term_text(term));
  }
  return fmt::format("{} of the {}, {}: {}", kind, column_words(quantity.at("column")),
                     iteration_text(quantity, quantity.contains("clock") ? "at equal processor time"
                                                                         : "at the end"),
                     joined(terms, kind == "ratio" ? " / " : ", "));
}

}  // namespace isoline::reports
