// Checkpoints: a file as it is, and the input as the state in a file that is right besides.
#include <new>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/execute.h"
#include "core/digest.h"
#include "core/trace.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {
namespace {

// The run that the state would be of.
void restore_from(const std::string& path) {
  static const Request request =
      named({.problem = complete_problem(catalog(), parse_spec("rosenbrock")),
             .optimizer = complete_optimizer(catalog(), parse_spec("adam")),
             .budget = {.iterations = 50}});
  static const benchmarks::Problem problem = make_problem(catalog(), request.problem, 0);
  static Trace trace;
  const benchmarks::OptimizerEntry& entry = catalog().optimizers.at("adam");
  const auto method = entry.make(request.optimizer.options, catalog().optimizers);
  trace.~Trace();
  new (&trace) Trace;
  optimizers::Meter meter(problem, request.budget,
                          needs_of(entry, request.optimizer.options, problem), trace);
  Vector theta = problem.start();
  constexpr double kNever = 1e9;
  try {
    benchmarks::Checkpoint(path, "cell", kNever).restore(*method, meter, theta);
  } catch (const benchmarks::DamagedCheckpoint&) {  // the cell begins anew
  }
}

}  // namespace

void checkpoint(std::string_view bytes) {
  const std::string state(bytes);
  const MemoryFile as_it_is(bytes);
  expect_read_or_refused([&] { restore_from(as_it_is.path()); });
  const MemoryFile right("isoline.checkpoint/2 cell\n" + digest(state) + state);
  expect_read_or_refused([&] { restore_from(right.path()); });
}

}  // namespace isoline::fuzz
