// isoline infer NETWORK --input FILE --output FILE: applies a trained network to observations.
#include <fmt/format.h>

#include "benchmarks/cli/verb.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/trained.h"
#include "core/errors.h"
#include "core/records/npy.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

struct InferArguments {
  std::string network, input, output, training_data;
  std::int64_t memory_bytes = 0;  // 0: as a cell's
  double seconds = 600;
};

void declare(VerbArguments& verb, InferArguments& given) {
  verb.text("NETWORK", given.network, "File of the trained network").required();
  verb.text(
      "--input", given.input,
      "Observations, one per row: .npy of shape (samples, length of y) or (samples, N, N), or "
      ".csv");
  verb.text("--training-data", given.training_data,
            "Instead of --input: apply the network to the N samples of the option data=N that it "
            "was trained on, and write their y* to this file");
  verb.text("--output", given.output, "Output file for the inferred x: .npy or .csv").required();
  verb.time("--time", given.seconds, "Time limit: 10s, 2m (default: 10m)");
  verb.memory("--memory", given.memory_bytes, "Memory limit (default: 4GB)");
}

// Reads, infers and writes; the sentence about it.
std::string inferred(const InferArguments& given, const Catalog& catalog) {
  const TrainedNetwork network = read_network(given.network);
  const Component component =
      complete_problem(catalog, network.problem.name, network.problem.options);
  require(component.is_learned,
          [&] { return given.network + " is not a trained network: its problem has no network"; });
  const Problem problem = make_problem(catalog, component, network.seed);
  require(given.training_data.empty() || !problem.has_fresh_batches(),
          "infer: --training-data requires a network that was trained with data=N");
  try {
    require_fitting(network, problem);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", given.network, error.what()));
  }
  const NumberArray input = given.training_data.empty()
                                ? read_numbers(given.input)
                                : samples_array(problem, problem.batch().input);
  const NumberArray output = infer(problem, network, input, given.input);
  if (!given.training_data.empty())
    write_numbers(given.training_data, samples_array(problem, problem.target()));
  write_numbers(given.output, output);
  return fmt::format("{}: {} inferred by {} trained on {} for {}", given.output,
                     reports::counted(std::size_t(output.shape[0]), "sample"),
                     network.optimizer.spec, network.problem.spec,
                     reports::counted(std::size_t(network.iterations), "iteration"));
}

// How the child process reports to its parent whether the user made a mistake.
constexpr char kSaid = '+', kMistaken = '-';

// In a process of its own, under limits: whatever a file holds costs that process alone.
int run(const InferArguments& given, Session& session) {
  require(given.input.empty() != given.training_data.empty(),
          "infer requires either --input or --training-data");
  const Catalog& catalog = session.catalog();
  const auto work = [&] {
    try {
      return kSaid + inferred(given, catalog);
    } catch (const UsageError& mistake) {
      return std::string(1, kMistaken) + mistake.what();
    }
  };
  const std::int64_t memory = given.memory_bytes > 0 ? given.memory_bytes : Limits{}.memory_bytes;
  const auto [text, failure] = isolated_text(work, given.seconds, memory);
  if (!text || text->empty()) {
    say(stderr, fmt::format("isoline: {} was not written: {}\n", given.output,
                            text ? "the process did not answer" : failure));
    return kWorse;
  }
  require(text->front() != kMistaken, [&] { return text->substr(1); });
  say(stdout, text->substr(1) + "\n");
  return kGood;
}

}  // namespace

void register_infer(VerbRegistry& registry) {
  registry.add(verb_of({.name = "infer",
                        .help_position = 220,
                        .summary = "Apply a network that `isoline train` wrote to observations",
                        .examples = "  isoline infer net.json --input observed.csv --output x.csv"},
                       declare, run));
}

}  // namespace isoline::benchmarks
