// The run loop in small, as the harness has it: begin, start, step and iterate, finish.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "benchmarks/run/keepers/keeper.h"
#include "core/spec.h"
#include "optimizers/optimizer.h"
#include "tests/problems/make.h"

namespace isoline::optimizers {

using problems::gradient_at;
using problems::loss_at;
using problems::loss_at_start;
using problems::make;

// The optimizer that docs/ shows, unless a reader has saved it in the tree.
void register_readme_examples(OptimizerRegistry& registry);

// Those that are made by their name alone.
inline const OptimizerRegistry& optimizers() {
  static const OptimizerRegistry all = [] {
    OptimizerRegistry registry("optimizer");
    register_optimizers(registry);
    register_readme_examples(registry);
    return registry.ready();
  }();
  return all;
}

struct Outcome {
  Vector theta;                                              // (n), final
  std::vector<Vector> path;                                  // θ after each step of ours
  std::unique_ptr<Trace> trace = std::make_unique<Trace>();  // large
  Parts parts;                                               // of its record
  Status status = Status::running;
};

inline OptionValues options_of_spec(const OptimizerEntry& entry, const std::string& text) {
  return complete_options(entry.options, entry.name, options_of(parse_spec(text)));
}

inline Outcome run_from(const Vector& start, const Problem& problem, const std::string& spec,
                        const Budget& budget) {
  const OptimizerEntry& entry = optimizers().at(parse_spec(spec).name);
  const OptionValues options = options_of_spec(entry, spec);
  const auto method = entry.make(options, optimizers());
  Outcome result;
  result.theta = start;
  Meter meter(problem, budget, needs_of(entry, options, problem), *result.trace,
              benchmarks::open_keepers(*result.trace));
  result.status = meter.begin(result.theta);
  Vector before = result.theta;
  try {
    method->start(meter, result.theta);
    while (result.status == Status::running) {
      before = result.theta;
      result.status = method->step(meter, result.theta);
      if (method->reports_iterations()) break;
      const Status seen = meter.iterate(result.theta);
      if (result.status == Status::running) result.status = seen;
      result.path.push_back(result.theta);
    }
  } catch (const BudgetSpent&) {  // the step is not taken
    result.theta = before;
    result.status = Status::budget;
  }
  result.theta = meter.finish(result.theta, result.status);
  result.status = result.trace->status;
  benchmarks::write_parts(*result.trace, result.parts);
  return result;
}

inline Outcome run(const Problem& problem, const std::string& spec, const Budget& budget) {
  return run_from(problem.start(), problem, spec, budget);
}

// `count` iterations, come what may: no target, no stall in so few.
inline Budget iterations(std::int64_t count) { return {.iterations = count, .target = 0}; }

inline Vector first_step(const Problem& problem, const std::string& spec) {
  return run(problem, spec, iterations(1)).theta - problem.start();
}

// Why a method cannot treat a problem; empty where it can.
inline std::string why(const std::string& spec, const Problem& problem) {
  const OptimizerEntry& entry = optimizers().at(parse_spec(spec).name);
  return why_inapplicable(entry, options_of_spec(entry, spec), problem);
}

inline void expect_near(const Vector& one, const Vector& other, Real tolerance,
                        const std::string& what) {
  EXPECT_LE((one - other).norm(), tolerance * other.norm()) << what;
}

}  // namespace isoline::optimizers
