// Estimates of cells, from measured forward solves.
#include "benchmarks/run/prediction.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/files.h"
#include "core/records/sheet.h"

namespace isoline::benchmarks {

double predicted_seconds(const Catalog& catalog, const Request& request, const ProblemCost& cost) {
  constexpr double kWorkPerIteration = 3, kSecondsPerFlop = 1e-9, kCallSeconds = 1e-7;
  const auto iterations = static_cast<double>(request.budget.iterations);
  const double work =
      std::min(static_cast<double>(request.budget.work), kWorkPerIteration * iterations);
  const OptimizerEntry& entry = catalog.optimizers.at(request.optimizer.name);
  double seconds = work * (cost.forward_seconds + kCallSeconds);
  if (entry.needs.contains(Oracle::jacobian) || entry.needs.contains(Oracle::hessian)) {
    const double steps = std::min(iterations, work / std::max(1.0, cost.unknowns));
    seconds += steps * kSecondsPerFlop * std::pow(cost.unknowns, 3);
  }
  return std::min(seconds, request.budget.seconds);
}

double Predictions::of(const Request& request) {
  const auto [at, is_new] = costs_.try_emplace(request.problem.spec);
  if (is_new) at->second = cost_of(request.problem);
  if (!(at->second.forward_seconds > 0)) return 0;
  return predicted_seconds(catalog_, request, at->second);
}

ProblemCost Predictions::cost_of(const Component& problem) const {
  const Sheet named{.kind = "problem", .name = problem.name, .spec = problem.spec};
  const std::filesystem::path path = folder_ / "components" / named.file_name();
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return {};
  try {
    const Sheet sheet = sheet_from_text(read_text(path), path.string());
    const double seconds = sheet.prices ? sheet.prices->forward_seconds : 0;
    return {seconds, static_cast<double>(sheet.unknowns)};
  } catch (const UsageError&) {
    return {};  // damaged: it predicts nothing
  }
}

}  // namespace isoline::benchmarks
