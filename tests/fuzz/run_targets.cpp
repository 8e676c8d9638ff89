// Targets for readers of benchmarks, over the components of the tree.
#include <algorithm>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/claim_cells.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/keepers/keeper.h"
#include "benchmarks/run/trained.h"
#include "core/files.h"
#include "core/json.h"
#include "core/trace.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {
namespace {

// Without components that start a program: fuzzed commands are never run.
const benchmarks::Catalog& catalog() {
  static const benchmarks::Catalog all = [] {
    benchmarks::Catalog whole = benchmarks::builtin_catalog();
    return benchmarks::Catalog{whole.problems.ready(), whole.optimizers.ready()};
  }();
  return all;
}

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
                          needs_of(entry, request.optimizer.options, problem), trace,
                          benchmarks::open_keepers(trace));
  Vector theta = problem.start();
  constexpr double kNever = 1e9;
  try {
    benchmarks::Checkpoint(path, "cell", kNever).restore(*method, meter, theta);
  } catch (const benchmarks::DamagedCheckpoint&) {  // the cell starts again
  }
}

// As main() has them: each ends with a zero, so what stands behind one is not of it.
std::vector<std::string> arguments_of(std::string_view bytes) {
  constexpr std::size_t kMost = 64;
  std::vector<std::string> arguments{"isoline"};
  while (!bytes.empty() && arguments.size() < kMost) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    const std::string line(bytes.substr(0, end));
    arguments.emplace_back(line.c_str());
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
  return arguments;
}

}  // namespace

void suite(std::string_view bytes) {
  constexpr std::uint64_t kMost = 500;
  static const benchmarks::Rates rates = benchmarks::Rates::builtin();
  expect_read_or_refused([&] {
    const benchmarks::Suite read =
        benchmarks::suite_from_json(parse_json(std::string(bytes), "the input"), "the input");
    const benchmarks::PlanSize size = size_of(catalog(), read);
    const auto requests = expand(catalog(), read, rates, kMost);
    if (requests.size() > size.cells) throw std::logic_error("more cells than were counted");
  });
}

void claims(std::string_view bytes) {
  static const benchmarks::Rates rates = benchmarks::Rates::builtin();
  expect_read_or_refused([&] {
    const Json json = parse_json(std::string(bytes), "the input");
    benchmarks::claims_from_json(catalog(), rates, json, "the input");
  });
}

void network(std::string_view bytes) {
  expect_read_or_refused([&] { benchmarks::network_from_text(std::string(bytes)); });
}

void checkpoint(std::string_view bytes) {
  const std::string state(bytes);
  const MemoryFile as_it_is(bytes);
  expect_read_or_refused([&] { restore_from(as_it_is.path()); });
  const MemoryFile right("isoline.checkpoint/2 cell\n" + digest(state) + state);
  expect_read_or_refused([&] { restore_from(right.path()); });
}

// An argument a line. No verb is run.
void command_line(std::string_view bytes) {
  std::vector<std::string> arguments = arguments_of(bytes);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  const int count = static_cast<int>(pointers.size());
  pointers.push_back(nullptr);
  expect_read_or_refused([&] { benchmarks::parse_only("isoline", count, pointers.data()); });
}

}  // namespace isoline::fuzz
