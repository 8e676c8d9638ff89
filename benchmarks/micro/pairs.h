// Ours against the bare thing it stands for, timed in turn, so that the noise of the machine falls
// on both. A benchmark's figures are medians over pairs: `ns` a call of ours, `bare_ns`, their
// `ratio` and difference `extra_ns`.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "benchmarks/plan/catalog.h"
#include "core/clock.h"
#include "core/spec.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks::micro {

// The cost of one call.
struct Cost {
  double seconds = 0;
};

// The mean over `calls` of `work`.
template <class Work>
Cost cost_of(int calls, Work&& work) {
  const std::uint64_t begin = ticks();
  for (int i = 0; i < calls; ++i) work();
  const auto elapsed = static_cast<double>(ticks() - begin);
  return {elapsed * seconds_per_tick() / calls};
}

struct Pair {
  std::function<Cost()> ours, bare;
};

// The promised ratio; 0 without a promise.
struct Goal {
  double ratio = 0, extra_ns = 0;
};

// `make` prepares a pair when its benchmark is chosen; it is then run `pairs` times.
void register_pair(const std::string& name, int pairs, const Goal& goal,
                   const std::function<Pair()>& make);

// One call a file.
void register_metering();
void register_libraries();
void register_grids();
void register_round_trips();
void register_spectral();
void register_networks();

// A problem by its spec, and a metered run of a method on it.

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
