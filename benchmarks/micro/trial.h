// A problem by its spec, and a metered run of a method on it.
#pragma once

#include <memory>
#include <string>

#include "benchmarks/plan/catalog.h"
#include "core/spec.h"

namespace isoline::benchmarks::micro {

inline const Catalog& catalog() {
  static const Catalog all = builtin_catalog();
  return all;
}

inline Problem make_problem(const std::string& text) {
  const Spec spec = parse_spec(text);
  return benchmarks::make_problem(catalog(), complete_problem(catalog(), spec), 0);
}

// Iterations without end, so that nothing but the method decides.
inline Budget endless() {
  return {.iterations = std::numeric_limits<std::int64_t>::max(), .target = 0};
}

inline Component complete_method(const std::string& text) {
  const Spec spec = parse_spec(text);
  return complete_optimizer(catalog(), spec);
}

inline std::unique_ptr<Optimizer> make_method(const std::string& text) {
  const Component method = complete_method(text);
  return catalog().optimizers.at(method.name).make(method.options, catalog().optimizers);
}

inline OracleSet needs(const std::string& text, const Problem& problem) {
  const Component method = complete_method(text);
  return needs_of(catalog().optimizers.at(method.name), method.options, problem);
}

// A method under way on a problem that outlives it.
struct Trial {
  Trial(const Problem& f, const std::string& spec, const Budget& budget)
      : problem(f), method(make_method(spec)), meter(f, budget, needs(spec, f), trace) {}

  const Problem& problem;
  Trace trace;
  std::unique_ptr<Optimizer> method;
  Meter meter;
};

}  // namespace isoline::benchmarks::micro
