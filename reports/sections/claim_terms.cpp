// Words for the yardstick.
#include "reports/sections/claim_terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/read/ranking.h"
#include "reports/sections/run_figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {

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
  // The law of agreement.cpp for a ratio of two readings.
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
