// Makes every component of a plan once.
#include "benchmarks/run/certificate.h"

#include <fmt/format.h>

#include <set>

#include "benchmarks/run/interrupts.h"
#include "benchmarks/run/isolate.h"
#include "optimizers/optimizer.h"
#include "problems/conformance.h"
#include "problems/problem.h"

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

// Certificates of problems from outside.

using problems::examine;
using problems::Finding;
namespace {

constexpr double kCertificateSeconds = 120;

// Empty if every property holds.
std::string broken_law_of(const Catalog& catalog, const Request& request) {
  const Problem problem = make_problem(catalog, request.problem, request.seed);
  RandomStream stream(request.seed, request.problem.name, "check");
  for (const Finding& finding : examine(problem, stream))
    if (!finding.holds())
      return fmt::format("'{}' is violated: {:.2e}, at most {:.1e} is allowed ({})",
                         finding.property, finding.figure, finding.limit, finding.reason);
  return "";
}

}  // namespace

void require_certified(const Catalog& catalog, const std::vector<Request>& requests,
                       const Store& store, Progress::Style style) {
  std::set<std::string> seen;
  std::vector<const Request*> firsts;
  for (const Request& request : requests)
    if (request.problem.foreign && !store.has(request) && seen.insert(request.problem.spec).second)
      firsts.push_back(&request);
  Progress progress(style, "certified", static_cast<std::int64_t>(firsts.size()), 0);
  for (const Request* request : firsts) {
    progress.started(request->problem.spec);
    const auto [broken, failure] =
        isolated_text([&] { return broken_law_of(catalog, *request); }, kCertificateSeconds,
                      Limits{}.memory_bytes, [&] { progress.show(); });
    if (asked_to_end() != Asked::nothing) return;
    const std::string reason = broken.value_or("it cannot be checked: " + failure);
    require(reason.empty(), [&] {
      return fmt::format("{} fails its checks and does not run: {}; `isoline check` lists all",
                         request->problem.spec, reason);
    });
    progress.finished({});
  }
}

}  // namespace isoline::benchmarks
