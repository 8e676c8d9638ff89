// Chooses one option of each pair of problem and optimizer over a grid, with an equal budget for
// all and on seeds of their own, and keeps the whole grid beside the winner.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/tuning_grid.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

struct TunedPair {
  Component problem;
  std::string optimizer;  // a name
  Budget budget;
  OptionValues options = {};  // that it has anyway, as from a paper
};

// Every pair is tried at seven values of its method's tunable option. While the best stands at an
// edge, one more is tried beyond it, three at most. A grid of one's own is for all pairs, and is
// not extended.
struct TuningPlan {
  std::vector<TunedPair> pairs;
  std::vector<std::uint64_t> seeds;
  std::optional<GivenGrid> grid;
};

struct TuningResult {
  std::shared_ptr<const Json> rows;  // of a table isoline.rates/1
  Outcome outcome;
};

// A row tells the values, their scores, the expected least loss (or error in x) of the best of b of
// them drawn at random, for b = 1 to all, whether the best still stands at an edge, and the budget
// of work where it is not that of the first pair. Pairs that are inapplicable have none; where
// every value failed the one nearest to the default stays.
TuningResult tune(const Catalog& catalog, const TuningPlan& plan,
                  const std::filesystem::path& folder, const RunOptions& options);

}  // namespace isoline::benchmarks
