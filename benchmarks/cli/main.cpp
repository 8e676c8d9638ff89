// The command line of Isoline.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/records/provenance.h"
#include "core/suggest.h"
#include "core/threads.h"

namespace isoline::benchmarks {
namespace {

constexpr const char* kAbout =
    "Isoline compares optimizers on physical inverse problems: every problem of a registry "
    "against\n"
    "every optimizer of a registry, one JSON record a run, and a report.";
constexpr const char* kExamples =
    "Examples:\n"
    "  isoline run                        the default suite, then its report\n"
    "  isoline run --problem 'sine[xi=1|32]' --optimizer 'adam[rate=1e-3],ceres-lm' --seeds 5\n"
    "  isoline describe sip               formula, options, needs and source\n"
    "  isoline check rosenbrock           are its derivatives right?\n"
    "  isoline audit gd adam sip          scaling, invariance, order: measured\n"
    "  isoline compare results/old results/new    what got worse?\n"
    "  isoline claims notebook            is what the notebook prints reproduced?\n\n"
    "Exit codes: 0 good, 1 wrong usage, 2 worse or failed, 3 better only, 4 not comparable.";

std::string command_of(int count, char** arguments) {
  std::string command = "isoline";
  for (int i = 1; i < count; ++i) {
    const std::string_view word = arguments[i];
    const bool is_plain = word.find_first_of(" '\"[]|*$&;<>()") == std::string_view::npos;
    command += is_plain ? fmt::format(" {}", word) : fmt::format(" '{}'", word);
  }
  return command;
}

// A misspelt verb, named with its nearest neighbour; empty where the first word is a verb.
std::string unknown_verb(const CLI::App& app, int count, char** arguments) {
  if (count < 2 || arguments[1][0] == '-') return "";
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
  if (std::ranges::find(verbs, arguments[1]) != verbs.end()) return "";
  return unknown_name("verb", arguments[1], verbs);
}

int run(int count, char** arguments) {
  Session session(command_of(count, arguments));
  CLI::App app(kAbout, "isoline");
  app.footer(kExamples);
  app.set_version_flag("--version", "isoline " + version());
  app.require_subcommand(1);
  for (const auto add : {add_run, add_report, add_compare, add_baseline, add_merge, add_claims,
                         add_list, add_describe, add_check, add_audit, add_validate, add_tune,
                         add_train, add_infer, add_completion})
    add(app, session);
  try {
    const std::string wrong = unknown_verb(app, count, arguments);
    require(wrong.empty(), [&] { return wrong; });
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    fmt::print(stderr, "isoline: {} (see isoline --help)\n", error.what());
    return kUsage;
  } catch (const UsageError& error) {
    fmt::print(stderr, "isoline: {}\n", error.what());
    return kUsage;
  } catch (const std::exception& error) {
    fmt::print(stderr, "isoline: {}\n", error.what());
    return kWorse;
  }
  return session.exit_code;
}

}  // namespace
}  // namespace isoline::benchmarks

int main(int count, char** arguments) {
  isoline::prepare_libraries(arguments);
  return isoline::benchmarks::run(count, arguments);
}
