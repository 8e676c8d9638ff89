// Certificates of problems from outside.
#include "benchmarks/run/certificate.h"

#include <fmt/format.h>

#include <set>

#include "benchmarks/run/isolated_text.h"
#include "problems/conformance.h"

namespace isoline::benchmarks {

using problems::examine;
using problems::Finding;
namespace {

constexpr double kCertificateSeconds = 120;

// Empty where every law holds.
std::string broken_law_of(const Catalog& catalog, const Request& request) {
  const Problem problem = make_problem(catalog, request.problem, request.seed);
  RandomStream stream(request.seed, request.problem.name, "check");
  for (const Finding& finding : examine(problem, stream))
    if (!finding.holds())
      return fmt::format("'{}' is broken: {:.2e}, and at most {:.1e} holds ({})", finding.property,
                         finding.figure, finding.limit, finding.reason);
  return "";
}

}  // namespace

void require_certified(const Catalog& catalog, const std::vector<Request>& requests,
                       const Store& store) {
  std::set<std::string> seen;
  for (const Request& request : requests) {
    if (!request.problem.foreign || store.has(request)) continue;
    if (!seen.insert(request.problem.spec).second) continue;
    const std::optional<std::string> broken =
        isolated_text([&] { return broken_law_of(catalog, request); }, kCertificateSeconds).text;
    require(!broken || broken->empty(), [&] {
      return fmt::format("{} is not certified, and not run: {}; `isoline check` lists all laws",
                         request.problem.spec, *broken);
    });
  }
}

}  // namespace isoline::benchmarks
