// isoline infer NETWORK --input FILE --output FILE: applies a trained network to observations.
#include <fmt/format.h>

#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/trained.h"
#include "core/records/number_file.h"

namespace isoline::benchmarks {

int infer_verb(const InferArguments& given, Session& session) {
  const TrainedNetwork network = read_network(given.network);
  const NumberArray input = read_numbers(given.input);
  const Component component =
      complete_problem(session.catalog(), network.problem.name, network.problem.options);
  const Problem problem = make_problem(session.catalog(), component, network.seed);
  require(problem.unknowns() == network.theta.size(), [&] {
    return fmt::format("{} holds {} parameters and its network has {}", given.network,
                       network.theta.size(), problem.unknowns());
  });
  const NumberArray output = infer(problem, network, input, given.input);
  write_numbers(given.output, output);
  fmt::print("{}: {} samples inferred by {} trained on {} for {} iterations\n", given.output,
             output.shape[0], network.optimizer.spec, network.problem.spec, network.iterations);
  return kGood;
}

}  // namespace isoline::benchmarks
