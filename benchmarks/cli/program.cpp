// From the arguments of main() to an exit code.
#include "benchmarks/cli/program.h"

#include <cstdio>
#include <filesystem>
#include <new>

#include "benchmarks/cli/command_line.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/build_parts.h"
#include "core/errors.h"
#include "core/exit.h"
#include "core/records/provenance.h"
#include "core/shell.h"
#include "core/threads.h"

namespace isoline {
namespace {

// As a shell would run it again, whatever folder the program lies in.
std::string command_of(const std::string& program, int count, char** arguments) {
  std::string command = program;
  for (int i = 1; i < count; ++i) command += " " + shell_word(arguments[i]);
  return command;
}

}  // namespace

int main(int count, char** arguments, const std::function<benchmarks::Catalog()>& catalog,
         const SourceTree& tree) {
  prepare_libraries(arguments);
  if (!tree.commit.empty()) set_program_tree(tree.commit, tree.is_dirty);
  benchmarks::set_program_sources(tree.sources);
  const std::string program = std::filesystem::path(arguments[0]).filename().string();
  benchmarks::Session session(command_of(program, count, arguments), catalog);
  try {
    return benchmarks::parse_and_run(program, count, arguments, session);
  } catch (const UsageError& error) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), error.what());
    return kUsage;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "%s: there is not enough memory for this\n", program.c_str());
    return kWorse;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), error.what());
    return kWorse;
  }
}

}  // namespace isoline
