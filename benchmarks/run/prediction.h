// How long a cell may take, from what its problem says of itself.
#pragma once

#include <filesystem>
#include <map>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

inline constexpr double kProcessSeconds = 1e-2;  // a fork, a record, its fsync: on a busy machine

struct ProblemCost {
  double forward_seconds = 0, unknowns = 0;
};

// Of its iterations, within its own time: every unit of work costs a forward, a factorizing step
// about n³ besides.
double predicted_seconds(const Catalog& catalog, const Request& request, const ProblemCost& cost);

// Of the cells of a result folder, whose sheets know what a forward solve takes: 0 where one does
// not. Each sheet is read once.
class Predictions {
 public:
  Predictions(const Catalog& catalog, std::filesystem::path folder)
      : catalog_(catalog), folder_(std::move(folder)) {}

  double of(const Request& request);

 private:
  ProblemCost cost_of(const Component& problem) const;

  const Catalog& catalog_;
  const std::filesystem::path folder_;
  std::map<std::string, ProblemCost> costs_;  // by spec
};

}  // namespace isoline::benchmarks
