// The built-in catalog, and components completed from their names and options.
#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {
namespace {

template <class Entry>
Component complete(const Entry& entry, const OptionValues& given) {
  OptionValues options = complete_options(entry.options, entry.name, given);
  Component component{.name = entry.name,
                      .spec = short_spec(entry.options, entry.name, options),
                      .revision = entry.revision,
                      .is_learned = asks_to_learn(options)};
  component.options = std::move(options);
  return component;
}

}  // namespace

Catalog builtin_catalog() {
  Catalog catalog;
  problems::register_problems(catalog.problems);
  optimizers::register_optimizers(catalog.optimizers);
  return catalog;
}

Component complete_problem(const Catalog& catalog, const std::string& name,
                           const OptionValues& options) {
  Component problem = complete(catalog.problems.at(name), options);
  if (problem.is_learned) {
    constexpr int kNetworkRevisions = 1000;  // more than any network will have
    const std::string network = parse_spec(problem.options.text("network")).name;
    problem.revision =
        problem.revision * kNetworkRevisions + networks::network_registry().at(network).revision;
  }
  return problem;
}

Component complete_optimizer(const Catalog& catalog, const std::string& name,
                             const OptionValues& options) {
  const OptimizerEntry& entry = catalog.optimizers.at(name);
  Component optimizer = complete(entry, options);
  entry.make(optimizer.options, catalog.optimizers);  // refuses a bad optimizer inside another
  return optimizer;
}

Component complete_problem(const Catalog& catalog, const Spec& spec) {
  return complete_problem(catalog, spec.name, options_of(spec));
}

Component complete_optimizer(const Catalog& catalog, const Spec& spec) {
  return complete_optimizer(catalog, spec.name, options_of(spec));
}

Problem make_problem(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  const ProblemEntry& entry = catalog.problems.at(problem.name);
  return entry.make(problem.options, Draw(seed, problem.name));
}

}  // namespace isoline::benchmarks
