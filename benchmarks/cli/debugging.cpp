// The next steps after a crash, as commands.
#include "benchmarks/cli/debugging.h"

#include <fmt/format.h>

#include <fstream>

#include "core/shell.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::rerun_arguments;
namespace {

namespace fs = std::filesystem;

// The binary itself: a debugger can't follow the launcher.
std::string program_path() {
  std::error_code unknown;
  const fs::path path = fs::read_symlink("/proc/self/exe", unknown);
  return shell_word(unknown ? "isoline" : path.string());
}

// As the system names it: "core", or a program that takes it.
std::string core_pattern() {
  std::string pattern;
  std::getline(std::ifstream("/proc/sys/kernel/core_pattern"), pattern);
  return pattern.empty() ? "core" : pattern;
}

}  // namespace

std::string advice_on(const Crash& crash, const fs::path& folder) {
  const std::string command =
      fmt::format("{} run {} --in-process", program_path(), rerun_arguments(crash.request));
  return fmt::format(
      "to debug {}:\n"
      "  record      {}: \"message\" says how it ended, \"output\" what it wrote last\n"
      "  alone       {}\n"
      "  debugger    gdb --args {}\n"
      "  core file   ulimit -c unlimited; {}\n"
      "              the system writes it to: {}\n",
      title_of(crash.request), (folder / crash.record).string(), command, command, command,
      printable(core_pattern()));
}

}  // namespace isoline::benchmarks
