// What a plan would do: looked up in the store, probed and estimated.
#include "benchmarks/run/preview.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmarks/run/isolate.h"
#include "core/clock.h"
#include "core/json.h"

namespace isoline::benchmarks {
namespace {

constexpr double kProbeSeconds = 30;
constexpr double kProcessSeconds = 1e-2;  // a fork, a record and its fsync, on a busy machine

// What one problem says of itself and of each optimizer, found in a process of its own.
struct Probe {
  double forward_seconds = 0;
  double unknowns = 0;
  std::map<std::string, std::string> reasons;  // by optimizer spec
};

double time_forward(const Problem& problem) {
  constexpr int kTimes = 5;
  Point point;
  double least = 1e9;
  for (int i = 0; i < kTimes; ++i) {
    const std::int64_t begin = monotonic_nanoseconds();
    problem.forward(problem.start(), point);
    least = std::min(least, 1e-9 * static_cast<double>(monotonic_nanoseconds() - begin));
  }
  return least;
}

Json probe(const Catalog& catalog, const std::vector<const Request*>& requests) {
  const Problem problem = make_problem(catalog, requests.front()->problem, 0);
  Json reasons = Json::object();
  for (const Request* request : requests) {
    const Component& optimizer = request->optimizer;
    reasons[optimizer.spec] =
        why_inapplicable(catalog.optimizers.at(optimizer.name), optimizer.options, problem);
  }
  return {{"forward_seconds", time_forward(problem)},
          {"unknowns", problem.unknowns()},
          {"reasons", reasons}};
}

Probe isolated_probe(const Catalog& catalog, const std::vector<const Request*>& requests) {
  const auto text =
      isolated_text([&] { return probe(catalog, requests).dump(); }, kProbeSeconds).text;
  if (!text) return {};  // the problem cannot be made here; its cells will say so when they run
  const Json found = parse_json(*text, "probe");
  return {found.at("forward_seconds"), found.at("unknowns"), found.at("reasons")};
}

// Every unit of work costs a forward; a factorizing step costs about n³ besides.
double estimate(const Catalog& catalog, const Request& request, const Probe& probed) {
  constexpr double kWorkPerIteration = 3, kSecondsPerFlop = 1e-9;
  const auto iterations = static_cast<double>(request.budget.iterations);
  double work = std::min(static_cast<double>(request.budget.work), kWorkPerIteration * iterations);
  const OptimizerEntry& entry = catalog.optimizers.at(request.optimizer.name);
  double seconds = work * (probed.forward_seconds + 1e-7);
  if (entry.needs.contains(Oracle::jacobian) || entry.needs.contains(Oracle::hessian)) {
    const double steps = std::min(iterations, work / std::max(1.0, probed.unknowns));
    seconds += steps * kSecondsPerFlop * std::pow(probed.unknowns, 3);
  }
  return std::min(seconds, request.budget.seconds) + kProcessSeconds;
}

}  // namespace

std::vector<PreviewedCell> preview(const Catalog& catalog, const std::vector<Request>& requests,
                                   const std::filesystem::path& folder, bool reuse) {
  std::map<std::string, std::vector<const Request*>> by_problem;
  for (const Request& request : requests) by_problem[request.problem.spec].push_back(&request);
  std::map<std::string, Probe> probes;
  for (const auto& [spec, some] : by_problem) probes[spec] = isolated_probe(catalog, some);
  const RecordsOfAnyBuild earlier(folder);
  std::vector<PreviewedCell> cells;
  for (const Request& request : requests) {
    const Probe& probed = probes.at(request.problem.spec);
    const auto reason = probed.reasons.find(request.optimizer.spec);
    PreviewedCell cell{.request = &request};
    cell.is_cached = Store::find_in(folder, request) || (reuse && earlier.find(request));
    if (reason != probed.reasons.end()) cell.why_inapplicable = reason->second;
    if (!cell.is_cached && cell.why_inapplicable.empty())
      cell.seconds = estimate(catalog, request, probed);
    cells.push_back(std::move(cell));
  }
  return cells;
}

}  // namespace isoline::benchmarks
