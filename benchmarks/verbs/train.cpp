// isoline train PROBLEM --out FILE: trains one network and stores it for `isoline infer`.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <new>

#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/trained.h"
#include "core/options.h"
#include "core/output.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

struct TrainArguments {
  std::string problem, optimizer = "sip", out, from;
  std::uint64_t seed = 0;
  std::int64_t iterations = 1000, memory_bytes = 0;  // 0: as a cell's
  double seconds = 0;                                // 0: no limit
  int threads = 1;
  bool quiet = false;
};

void declare(VerbArguments& verb, TrainArguments& given) {
  verb.text("PROBLEM", given.problem, "Problem: 'sine[xi=32]'; mode=learn is implied").required();
  verb.text("--out", given.out, "Output file, JSON").required();
  verb.text("--optimizer", given.optimizer, "Training method").shown();
  verb.text("--from", given.from,
            "Network written by `train`; training starts from its "
            "parameters");
  verb.whole("--iterations", given.iterations, "Number of training steps");
  verb.seed("--seed", given.seed, "Seed of the start and of the samples");
  verb.whole("--threads", given.threads, "Number of threads that libraries use", kThreads);
  verb.time(
      "--time", given.seconds,
      "Time limit of training: 10s, 2m. At this limit, the network is saved as it is; after twice "
      "this processor time, the process is killed");
  verb.memory("--memory", given.memory_bytes, "Memory limit (default: 4GB)");
  verb.flag("--quiet", given.quiet, "Do not show progress");
  verb.plugins();
}

Request request_of(const TrainArguments& given, const Catalog& catalog) {
  const Spec problem_spec = parse_spec(given.problem), spec = parse_spec(given.optimizer);
  OptionValues options = options_of(problem_spec);
  if (!options.contains(kModeOption)) options.set(kModeOption, kLearnMode);
  const Component problem = complete_problem(catalog, problem_spec.name, options);
  require(problem.is_learned,
          "train: with mode=direct, there is no network to train; remove this option");
  const Rates rates = Rates::builtin();
  return named({.problem = problem,
                .optimizer = with_rates(catalog, spec, rates.find(problem, spec.name)),
                .seed = given.seed,
                .budget = {.iterations = given.iterations,
                           .seconds = given.seconds > 0 ? given.seconds : Budget{}.seconds,
                           .target = 0},
                .threads = given.threads,
                .rates = ""});
}

bool is_trained(const Trace& trace) {
  return trace.status == Status::budget || trace.status == Status::converged;
}

// Before hours of training: a network that cannot be written is not trained.
void require_writable(const std::string& out) {
  const std::filesystem::path path(out), parent = path.parent_path();
  const std::filesystem::path folder = parent.empty() ? "." : parent;
  require_ours(path, kNetworkSchema);
  require(access(folder.c_str(), W_OK) == 0,
          [&] { return fmt::format("cannot write {}: {}", out, std::strerror(errno)); });
}

void write(const Catalog& catalog, const Request& request, const Vector& theta, const Trace& trace,
           const std::string& out) {
  const Problem problem = make_problem(catalog, request.problem, request.seed);
  write_network({.problem = request.problem,
                 .optimizer = request.optimizer,
                 .seed = request.seed,
                 .iterations = trace.last.iteration,
                 .loss = trace.last.loss,
                 .x_error = trace.last.x_error,
                 .theta = theta,
                 .statistics = averaged_statistics(problem, theta, trace.last.iteration)},
                out);
}

// θ of a network of this very problem, however it was trained; nothing without a file.
Vector start_from(const Catalog& catalog, const Request& request, const std::string& file) {
  if (file.empty()) return {};
  const TrainedNetwork network = read_network(file);
  require(network.problem.spec == request.problem.spec, [&] {
    return fmt::format("{} is a network of {}, not of {}", file, network.problem.spec,
                       request.problem.spec);
  });
  read_as(file,
          [&] { require_fitting(network, make_problem(catalog, request.problem, request.seed)); });
  return network.theta;
}

// In the worker: the run, then the network with its statistics.
void train_and_write(const Catalog& catalog, const Request& request, Vector theta,
                     const std::string& out, Trace& trace) {
  execute(catalog, request, trace, {}, &theta);
  if (!is_trained(trace)) return;
  try {
    write(catalog, request, theta, trace, out);
  } catch (const std::bad_alloc&) {
    throw;  // the worker knows it
  } catch (const std::exception& error) {
    trace.status = Status::failed;
    set_text(trace.message, error.what());
  }
}

void show(const Trace& trace, std::int64_t iterations, const char* end) {
  say(stderr,
      fmt::format("\riteration {} of {}, loss {:.3g}, error in x {:.3g}   {}", trace.last.iteration,
                  iterations, trace.last.loss, trace.last.x_error, end));
}

// How far it has come, as a line that each call overwrites.
void watch(Worker& worker, std::int64_t iterations, bool is_shown) {
  while (!worker.poll()) {
    constexpr int kMilliseconds = 200;
    pollfd ending{worker.descriptor(), POLLIN, 0};
    ::poll(&ending, 1, kMilliseconds);
    if (is_shown) show(worker.trace(), iterations, "");
  }
  if (is_shown) show(worker.trace(), iterations, "\n");
}

int run(const TrainArguments& given, Session& session) {
  const Request request = request_of(given, session.catalog());
  require_writable(given.out);
  require_sound(session.catalog(), {request});
  const Vector start = start_from(session.catalog(), request, given.from);
  Limits standard{.hard_seconds = kMostSeconds};  // unless --time is given
  if (given.memory_bytes > 0) standard.memory_bytes = given.memory_bytes;
  Worker worker;
  worker.start(
      [&](Trace& trace) { train_and_write(session.catalog(), request, start, given.out, trace); },
      limits_of(request, standard), request.threads);
  watch(worker, given.iterations, !given.quiet && isatty(STDERR_FILENO) != 0);
  const Trace& trace = worker.trace();
  require(trace.status != Status::inapplicable, [&] {
    return fmt::format("{} cannot train {}: {}", request.optimizer.spec, request.problem.spec,
                       trace.message);
  });
  if (!is_trained(trace)) {
    const std::string reason = trace.message;
    say(stderr, fmt::format("isoline: no network was written: {}{}{}\n", name_of(trace.status),
                            reason.empty() ? "" : ": ", reason));
    return kWorse;
  }
  say(stdout, fmt::format("{}: {} by {}, {}, validation loss {:.4g}, error in x {:.4g}\n",
                          given.out, request.problem.spec, request.optimizer.spec,
                          reports::counted(std::size_t(trace.last.iteration), "iteration"),
                          trace.last.loss, trace.last.x_error));
  return kGood;
}

}  // namespace

void register_train(VerbRegistry& registry) {
  registry.add(verb_of<TrainArguments>(
      {.name = "train",
       .help_position = 210,
       .summary = "Train a network to invert a problem, and write it to a file",
       .examples =
           "  isoline train 'sine[xi=32]' --optimizer sip --iterations 1000 --out net.json\n"
           "  isoline train 'sine[xi=32]' --from net.json --optimizer adam --out longer.json"},
      declare, run));
}

}  // namespace isoline::benchmarks
