// isoline infer NETWORK --input FILE --output FILE: applies a trained network to observations.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/trained.h"
#include "core/records/number_file.h"

namespace isoline::benchmarks {
namespace {

struct InferArguments {
  std::string network, input, output;
};

void infer_file(const InferArguments& given, Session& session) {
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
}

}  // namespace

void add_infer(CLI::App& app, Session& session) {
  const auto given = std::make_shared<InferArguments>();
  CLI::App* verb =
      app.add_subcommand("infer", "Apply a network that `isoline train` wrote to observations");
  verb->add_option("NETWORK", given->network, "File of the trained network")->required();
  verb->add_option("--input", given->input,
                   "Observations, one a row: .npy of shape (samples, numbers) or (samples, N, N), "
                   "or .csv")
      ->required();
  verb->add_option("--output", given->output, "Where to write the inferred x: .npy or .csv")
      ->required();
  verb->callback([given, &session] { infer_file(*given, session); });
}

}  // namespace isoline::benchmarks
