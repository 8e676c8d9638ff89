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
#include "benchmarks/run/tuning_score.h"

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

// One pair's grid and what it came to.
struct TunedOption {
  std::string problem, optimizer, option;  // "rate", or "rate of adam" inside another method
  std::vector<Real> values;                // ascending
  std::vector<TuningScore> scores;
  std::size_t best = 0;
  bool is_at_edge = false;  // of the grid, and better than its neighbour
};

struct TuningResult {
  std::shared_ptr<const Json> rows;  // of a table isoline.rates/1
  std::vector<TunedOption> tuned;    // the same, one a row
  std::size_t inapplicable = 0;      // pairs without a row
  Outcome outcome;                   // runs and seconds are those of all rounds
};

// A row tells the values, their scores, the expected least loss (or error in x) of the best of b of
// them drawn at random, for b = 1 to all, whether the best still stands at an edge, and the budget
// of work where it is not that of the first pair. Pairs that are inapplicable have none; where
// every value failed the one nearest to the default stays.
TuningResult tune(const Catalog& catalog, const TuningPlan& plan,
                  const std::filesystem::path& folder, const RunOptions& options);

}  // namespace isoline::benchmarks
