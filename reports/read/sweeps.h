// Two options that were swept together: a grid of settings that differ in nothing else.
#pragma once

#include <string>
#include <vector>

#include "core/results/ranking.h"

namespace isoline::reports {

using namespace results;

// A sweep of one problem and one optimizer by name. Its options belong to the problem, the
// optimizer, or a part inside one of them: "batch", "kappa", "network-optimizer.rate".
struct SweepGrid {
  std::string problem, optimizer;
  std::string row, column;  // options
  std::vector<Real> rows, columns;
  std::vector<std::vector<std::vector<std::size_t>>> runs;  // indices, [row][column]
  std::int64_t iterations = 0;                              // of each run, or
  std::int64_t samples = 0;                                 // where batches differ in size
};

// Grids of at least two by three values with runs in three quarters of their cells, the largest
// first.
std::vector<SweepGrid> sweep_grids(const Comparison& comparison);

}  // namespace isoline::reports
