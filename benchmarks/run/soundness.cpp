// Makes every component of a plan once.
#include "benchmarks/run/soundness.h"

#include <set>

#include "benchmarks/run/isolated_text.h"

namespace isoline::benchmarks {
namespace {

// The complaint, or nothing. Direct problems were checked whole when their options were completed.
std::string complaint_about(const Catalog& catalog, const Request& request) {
  try {
    const OptimizerEntry& entry = catalog.optimizers.at(request.optimizer.name);
    entry.make(request.optimizer.options, catalog.optimizers);
    if (request.problem.is_learned) make_problem(catalog, request.problem, request.seed);
  } catch (const UsageError& error) {
    return error.what();
  } catch (const std::exception&) {
    return "";  // its cells end as `failed` and say so
  }
  return "";
}

}  // namespace

void require_sound(const Catalog& catalog, const std::vector<Request>& requests) {
  constexpr double kSeconds = 60;
  const auto first_complaint = [&] {
    std::set<std::string> problems, optimizers;
    for (const Request& request : requests) {
      const bool is_new_problem = problems.insert(request.problem.spec).second;
      const bool is_new_optimizer = optimizers.insert(request.optimizer.spec).second;
      if (!is_new_problem && !is_new_optimizer) continue;
      const std::string text = complaint_about(catalog, request);
      if (!text.empty()) return text;
    }
    return std::string();
  };
  const auto complaint = isolated_text(first_complaint, kSeconds).text;
  if (complaint && !complaint->empty()) throw UsageError(*complaint);
}

}  // namespace isoline::benchmarks
