// The built-in catalog, and components completed from their names and options.
#include "benchmarks/plan/catalog.h"

#include "core/spec.h"

namespace isoline::benchmarks {
namespace {

template <class Entry>
Component complete(const Entry& entry, const Json& given) {
  const Json options = complete_options(entry.options, entry.name, given);
  return {.name = entry.name,
          .options = options,
          .spec = short_spec(entry.options, entry.name, options),
          .revision = entry.revision};
}

}  // namespace

Catalog builtin_catalog() {
  Catalog catalog;
  problems::register_problems(catalog.problems);
  optimizers::register_optimizers(catalog.optimizers);
  return catalog;
}

Component complete_problem(const Catalog& catalog, const std::string& name, const Json& options) {
  Component problem = complete(catalog.problems.at(name), options);
  if (problem.options.value("mode", "") == "learn") {
    constexpr int kNetworkRevisions = 1000;  // more than any network will have
    const std::string network = parse_spec(problem.options["network"].get<std::string>()).name;
    problem.revision =
        problem.revision * kNetworkRevisions + networks::network_registry().at(network).revision;
  }
  return problem;
}

Component complete_optimizer(const Catalog& catalog, const std::string& name, const Json& options) {
  const OptimizerEntry& entry = catalog.optimizers.at(name);
  Component optimizer = complete(entry, options);
  entry.make(optimizer.options, catalog.optimizers);  // refuses a bad optimizer inside another
  return optimizer;
}

Problem make_problem(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  const ProblemEntry& entry = catalog.problems.at(problem.name);
  return entry.make(problem.options, Draw(seed, problem.name));
}

}  // namespace isoline::benchmarks
