// The built-in catalog, and components completed from their names and options.
#include "benchmarks/catalog.h"

namespace isoline {
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
  register_problems(catalog.problems);
  register_optimizers(catalog.optimizers);
  return catalog;
}

Component complete_problem(const Catalog& catalog, const std::string& name, const Json& options) {
  return complete(catalog.problems.at(name), options);
}

Component complete_optimizer(const Catalog& catalog, const std::string& name, const Json& options) {
  return complete(catalog.optimizers.at(name), options);
}

Problem make_problem(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  const ProblemEntry& entry = catalog.problems.at(problem.name);
  return entry.make(problem.options, Draw(seed, problem.name));
}

}  // namespace isoline
