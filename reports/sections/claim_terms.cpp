// Reads figures off records, columns of their curves and what their paths come to; finds the runs
// of a claim's terms; says what both are.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ranges>

#include "core/json.h"
#include "reports/sections/claims.h"
#include "reports/sections/figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kAbsent = std::numeric_limits<Real>::quiet_NaN();
constexpr std::string_view kSeries = "series: ";
constexpr std::string_view kUntil = "until: ";  // then a column, and what it falls to

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
  if (rows.empty()) return kAbsent;
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
  if (row == 0) return kAbsent;  // the others are of the step that led to the row
  if (column == "alignment") return first_step(x, false);
  if (column == "turn") return first_step(y, true);
  const Real before = x.at(row - 1).at(1), step = std::abs(x.at(row).at(1) - before);
  if (column == "step_2") return step;
  return column == "relative_step_2" ? step / std::abs(before) : kAbsent;
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
  if (!(first > 0)) return kAbsent;
  return last > 0 ? first / last : kNever;
}

// The cost, in the unit of the place, when the column was first at most a bound; infinite if it
// never was.
Real spent_until(const Record& record, const Place& place) {
  const Curve& curve = record.curve;
  const auto& [name, bound] = bound_of(place.column);
  const std::vector<Real>* column = column_of(record, name);
  if (column == nullptr) return kAbsent;
  for (std::size_t i = 0; i <= index_at(curve, place); ++i) {
    if (!(value_at(*column, i) <= bound)) continue;
    if (place.seconds) return curve.processor_seconds.at(i);
    return static_cast<Real>(place.work ? curve.work.at(i) : curve.iteration[i]);
  }
  return kNever;
}

}  // namespace

std::pair<std::string, Real> bound_of(const std::string& column) {
  const std::size_t last = column.rfind(' ');
  return {column.substr(kUntil.size(), last - kUntil.size()), std::stod(column.substr(last))};
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
               ? kAbsent
               : 1e3 * record.summary.wall_seconds / static_cast<Real>(record.summary.iterations);
  if (curve.iteration.empty()) return kAbsent;
  const std::size_t index = index_at(curve, place);
  if (name == "loss_peak") return std::ranges::max(curve.loss | std::views::take(index + 1));
  if (name == "loss_drop") return curve.loss[0] - curve.loss[index];
  if (name == "slowdown") return slowdown(curve, index);
  if (name.starts_with(kUntil)) return spent_until(record, place);
  if (const auto* column = column_of(record, name)) {
    if (column->empty()) return kAbsent;
    const Real value = value_at(*column, index);
    const bool is_lost = std::isnan(value) && name.find("gradient") == std::string::npos;
    return is_lost && !name.starts_with(kSeries) ? kNever : value;  // it diverged
  }
  return record.trajectory ? path_figure(record, place) : kAbsent;
}

std::string column_words(const std::string& column) {
  if (column.starts_with(kSeries)) return column.substr(kSeries.size());
  if (column.starts_with(kUntil)) {
    const auto& [name, bound] = bound_of(column);
    return words("column.until", column_words(name), bound);
  }
  const std::string key = "column." + column;
  return all_sentences().contains(key) ? words(key) : column;
}

// Finds the runs of a claim's terms and reads their figures.

using Json = nlohmann::json;

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

std::vector<Real> equal_spending(const Json& cells, const ByCell& runs, std::int64_t iterations,
                                 bool is_work) {
  std::vector<Real> spent;
  for (const Json& term : cells)
    for (const Json& alternative : term) {
      const Json& all = alternative.at("cells");
      spent.resize(std::max(spent.size(), all.size()), kNever);
      for (std::size_t seed = 0; seed < all.size(); ++seed) {
        const Summary& summary = runs.at(all[seed].get<std::string>())->summary;
        if (summary.iterations == 0) continue;
        const Real whole = is_work ? static_cast<Real>(summary.work) : summary.processor_seconds;
        spent[seed] = std::min(spent[seed], whole / static_cast<Real>(summary.iterations) *
                                                static_cast<Real>(iterations));
      }
    }
  return spent;
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
                           std::int64_t iterations, Null null, ReadAt at) {
  constexpr std::int64_t kThird = 3;
  const Json& quantity = claim.at("quantity");
  const bool is_equal = quantity.value("clock", "") == "seconds";
  const bool is_work = at == ReadAt::equal_work;
  const std::vector<Real> spent =
      is_equal ? equal_spending(cells, runs, iterations, is_work) : std::vector<Real>();
  std::vector<Term> terms;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Json& asked = quantity.at("terms").at(i);
    Term& term = terms.emplace_back(Term{.figures = {},
                                         .at = asked.value("at", 1.0),
                                         .scale = asked.value("scale", 1.0),
                                         .is_worst = asked.value("of", "best") == "worst"});
    for (const Json& alternative : cells[i]) {
      auto& values = term.figures.emplace_back();
      for (const Json& cell : alternative.at("cells")) {
        const Record& run = *runs.at(cell.get<std::string>());
        Place place = place_of(claim, asked);
        const bool is_third = at == ReadAt::third_of_sip && run.request.optimizer.name == "sip";
        if (null == Null::untrained) place.iteration = 0;
        if (is_third && !place.iteration) place.iteration = iterations / kThird;
        if (is_equal && !place.iteration) {
          const Real most = spent.at(values.size());
          if (is_work)
            place.work = std::llround(most);
          else
            place.seconds = most;
        }
        values.push_back(figure_of(run, place));
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
  const Json contrasts = claim.value("contrasts", Json::array());
  return std::ranges::any_of(contrasts, has_rivals);
}

// Words for the figures of a claim.

namespace {

std::string tolerance_text(const Json& tolerance) {
  const std::string from = tolerance.at("from");
  if (from == "none" || from == "order") return words("tolerance." + from);
  if (from == "digits") return words("tolerance.digits", real_of(tolerance["absolute"]));
  const Real t = real_of(tolerance["relative"]);
  const std::string text = words("tolerance." + from, 100 * t);
  if (from == "about" || tolerance.value("values", 1) != 2) return text;
  // The band of quantities.cpp for a ratio of two readings.
  return words("tolerance.two", text, 100 * ((1 - t) / (1 + t) - 1), 100 * ((1 + t) / (1 - t) - 1));
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

std::string reading_text(const Json& claim) {
  const std::string from = claim.at("tolerance").at("from");
  if (from != "figure" && from != "digitized") return "";
  const Json& source = claim.at("source");
  return words("reading." + from, source.value("figure", source.value("section", "a figure")));
}

std::string quantity_text(const Json& claim) {
  const Json& quantity = claim.at("quantity");
  const std::string kind = quantity.at("kind");
  std::vector<std::string> terms;
  for (const Json& term : quantity.at("terms")) terms.push_back(term_text(term));
  return fmt::format("{} of the {}, {}: {}", kind, column_words(quantity.at("column")),
                     iteration_text(quantity, quantity.contains("clock") ? "at equal processor time"
                                                                         : "at the end"),
                     joined(terms, kind == "ratio" ? " / " : ", "));
}

}  // namespace isoline::reports
