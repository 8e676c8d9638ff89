// Chooses one option of each pair of problem and optimizer over a grid, with an equal budget for
// all and on seeds of their own, and keeps the whole grid beside the winner.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "benchmarks/run/run_plan.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

struct TuningGrid {
  std::string option = "rate";
  std::vector<Real> values;  // in `unit`
  // "one"; "cauchy": ‖∇L‖²/‖J∇L‖² at the problem's start, the natural unit of a step along ∇L; or
  // "published": the pair's own rate in the tables that are not tuned.
  std::string unit = "one";
};

// "rate=1e-4..1e-1x4": four values from 1e-4 to 1e-1, evenly on a logarithmic axis.
TuningGrid parse_grid(const std::string& text, const std::string& unit);

// Every problem with every optimizer at every value and seed. An optimizer that has no such option
// itself is given it in its network's optimizer; its other options are those of the tables.
struct TuningPlan {
  std::vector<Component> problems;
  std::vector<std::string> optimizers;  // names
  TuningGrid grid;
  std::vector<std::uint64_t> seeds;
  Budget budget;
};

struct TuningResult {
  std::shared_ptr<const Json> rows;  // of a table isoline.rates/1
  Outcome outcome;
};

// The score of a value: the median work to τ = 1e-6, then the median final loss; less is better,
// and of a learning problem the loss alone, on its validation. A value with which any seed diverges
// or fails has neither. Each row also tells the expected least loss of the best of b values drawn
// at random from the grid, for b = 1 to all of them.
TuningResult tune(const Catalog& catalog, const TuningPlan& plan,
                  const std::filesystem::path& folder, const RunOptions& options);

// E[best of b] of n losses: Σ y₍ᵢ₎ C(n − i, b − 1)/C(n, b) over the sorted ones, for b = 1 … n.
std::vector<Real> best_of(std::vector<Real> losses);

}  // namespace isoline::benchmarks
