// Finds the runs of a claim's terms and reads their figures.
#include "reports/sections/claim_terms.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json.h"

namespace isoline::reports {

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

}  // namespace isoline::reports
