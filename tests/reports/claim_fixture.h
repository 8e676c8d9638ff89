// Claims and runs of two optimizers with figures that can be worked out by hand.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "reports/sections/verdicts.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {

// A run whose error in x is `error` throughout; its cell is named by optimizer and seed.
inline Record run_of(const std::string& optimizer, std::uint64_t seed, Real error) {
  Record record = record_of({.optimizer = optimizer, .seed = seed});
  record.cell = optimizer + std::to_string(seed);
  for (Real& value : record.curve.x_error) value = error;
  return record;
}

struct Asked {
  std::string kind = "ratio";
  Json published = {{"value", 10}};
  Json tolerance = {{"from", "text"}, {"relative", 0.05}};
  std::vector<std::string> optimizers = {"adam", "sip"};
  std::int64_t seeds = 3, iterations = 100;
  Json more = Json::object();  // of the quantity
};

inline Json claim_of(const Asked& asked) {
  Json terms = Json::array(), cells = Json::array();
  for (const std::string& optimizer : asked.optimizers) {
    terms.push_back({{"optimizer", optimizer}});
    Json digests = Json::array();
    for (std::int64_t seed = 0; seed < asked.seeds; ++seed)
      digests.push_back(optimizer + std::to_string(seed));
    cells.push_back({{{"title", "square × " + optimizer}, {"cells", digests}}});
  }
  Json quantity{{"kind", asked.kind}, {"column", "x_error"}, {"terms", terms}};
  quantity.update(asked.more);
  return {{"id", "claim"},
          {"sentence", "One is ahead of the other."},
          {"source", {{"paper", "Someone (2022)"}, {"figure", "Figure 1"}}},
          {"cells", {{{"iterations", asked.iterations}, {"seeds", "3"}, {"terms", cells}}}},
          {"quantity", quantity},
          {"published", asked.published},
          {"tolerance", asked.tolerance}};
}

// Medians 20 and 2: a ratio of 10.
inline std::vector<Record> adam_and_sip() {
  std::vector<Record> runs;
  for (const auto& [seed, adam, sip] :
       {std::tuple{0, 20.0, 2.0}, std::tuple{1, 10.0, 1.0}, std::tuple{2, 90.0, 3.0}}) {
    runs.push_back(run_of("adam", seed, adam));
    runs.push_back(run_of("sip", seed, sip));
  }
  return runs;
}

inline Judgement judgement_of(const Asked& asked, const std::vector<Record>& runs) {
  return judge(Json::array({claim_of(asked)}), runs).at(0);
}

}  // namespace isoline::reports
