// A claim on one problem, as the report gets it: its cells are named by optimizer and seed.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/json.h"

namespace isoline::reports {

struct AskedClaim {
  std::string kind = "ratio";
  Json published = {{"value", 10}};
  Json tolerance = {{"from", "text"}, {"relative", 0.05}};
  std::vector<std::string> optimizers = {"adam", "sip"};
  std::int64_t seeds = 3, iterations = 100;
  Json more = Json::object();  // of the quantity
};

inline Json asked_cells(const std::string& optimizer, std::int64_t seeds = 3) {
  Json digests = Json::array();
  for (std::int64_t seed = 0; seed < seeds; ++seed)
    digests.push_back(optimizer + std::to_string(seed));
  return {{{"title", "square × " + optimizer}, {"cells", digests}}};
}

inline Json claim_of(const AskedClaim& asked) {
  Json terms = Json::array(), cells = Json::array();
  for (const std::string& optimizer : asked.optimizers) {
    terms.push_back({{"optimizer", optimizer}});
    cells.push_back(asked_cells(optimizer, asked.seeds));
  }
  Json quantity{{"kind", asked.kind}, {"column", "x_error"}, {"terms", terms}};
  quantity.update(asked.more);
  return {{"id", "claim"},
          {"sentence", "One is ahead of the other."},
          {"source", {{"paper", "Someone (2022)"}, {"figure", "Figure 1"}}},
          {"cells", {{{"iterations", asked.iterations}, {"seeds", "3"}, {"terms", cells}}}},
          {"quantity", quantity},
          {"published", asked.published},
          {"tolerance", asked.tolerance},
          {"caveat", "Drawn by hand."}};
}

}  // namespace isoline::reports
