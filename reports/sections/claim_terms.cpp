// Finds the runs of the terms of claims, and reads their figures.
#include "reports/sections/claim_terms.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "core/json.h"

namespace isoline::reports {
namespace {

constexpr std::array<const char*, 2> kTermLists = {"terms", "contrast_terms"};

}  // namespace

Place place_of(const Json& claim, const Json& term) {
  const Json& quantity = claim.at("quantity");
  Place place{.column = quantity.at("column"), .iteration = std::nullopt, .table = {}};
  const Json& from = term.contains("iteration") ? term : quantity;
  if (from.contains("iteration")) place.iteration = from["iteration"].get<std::int64_t>();
  const Json& published = claim.at("published");
  if (published.contains("table")) published["table"].get_to(place.table);
  return place;
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

std::vector<std::string> cells_of(const Json& set) {
  std::vector<std::string> cells;
  for (const char* list : kTermLists)
    for (const Json& term : set.value(list, Json::array()))
      for (const Json& alternative : term)
        for (const Json& cell : alternative.at("cells")) cells.push_back(cell);
  return cells;
}

std::vector<Term> terms_of(const Json& claim, const Json& cells, const ByCell& runs) {
  std::vector<Term> terms;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Json& asked = claim.at("quantity").at("terms").at(i);
    const Place place = place_of(claim, asked);
    Term& term = terms.emplace_back(Term{.figures = {},
                                         .at = asked.value("at", 1.0),
                                         .scale = asked.value("scale", 1.0),
                                         .is_worst = asked.value("of", "best") == "worst"});
    for (const Json& alternative : cells[i]) {
      auto& values = term.figures.emplace_back();
      for (const Json& cell : alternative.at("cells"))
        values.push_back(figure_of(*runs.at(cell.get<std::string>()), place));
    }
  }
  return terms;
}

}  // namespace isoline::reports
