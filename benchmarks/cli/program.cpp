// From the arguments of main() to an exit code.
#include "benchmarks/cli/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/claim_cells.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/process_group.h"
#include "core/errors.h"
#include "core/records/json_view.h"
#include "core/records/provenance.h"
#include "core/shell.h"
#include "core/status.h"
#include "core/text.h"
#include "core/threads.h"

namespace isoline::benchmarks {
namespace {

// Loads it once in another process first, so that a crash while loading becomes a message.
void require_loadable(const std::string& path) {
  constexpr double kSeconds = 30;
  const auto load = [&] {
    Catalog alone;
    try {
      add_plugin(alone, path);
    } catch (const UsageError&) {  // which this process then meets itself
    }
    return std::string();
  };
  const IsolatedText loaded = isolated_text(load, kSeconds);
  require(loaded.text.has_value(),
          [&] { return fmt::format("{} cannot be loaded: {}", path, loaded.failure); });
}

}  // namespace

Session::Session(std::string command, std::function<Catalog()> make)
    : command_(std::move(command)), make_(std::move(make)) {}

const Catalog& Session::catalog() {
  if (catalog_) return *catalog_;
  Catalog made = make_();
  for (const std::string& path : plugins_) try {
      require_loadable(path);
      add_plugin(made, path);
    } catch (const UsageError& error) {
      throw UsageError(std::string("--plugin: ") + error.what());
    }
  catalog_ = std::make_shared<const Catalog>(std::move(made));
  return *catalog_;
}

const std::vector<Claim>& Session::claims() {
  if (!claims_) claims_ = std::make_shared<const std::vector<Claim>>(builtin_claims_of(catalog()));
  return *claims_;
}

}  // namespace isoline::benchmarks

namespace isoline {
namespace {

// As a shell would run it again, whatever folder the program lies in.
std::string command_of(const std::string& program, int count, char** arguments) {
  std::string command = program;
  for (int i = 1; i < count; ++i) command += " " + shell_word(arguments[i]);
  return valid_utf8(command);
}

// Else the first file that is opened takes the place of a closed stream, and gets its text.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    const int how = stream == STDERR_FILENO ? O_WRONLY : O_RDONLY;  // output fails, and is reported
    if (open("/dev/null", how) != stream) _exit(1);
  }
}

int left_with(int code, const std::string& program, const char* what) {
  try {
    say(stderr, program + ": " + what + "\n");
  } catch (const std::exception&) {  // no caller remains to report this to
  }
  return code;
}

int code_of(const std::string& program, int count, char** arguments, benchmarks::Session& session) {
  try {
    const int code = benchmarks::parse_and_run(program, count, arguments, session);
    if (std::fflush(stdout) == 0) return code;
    return left_with(kWorse, program,
                     fmt::format("cannot write standard output: {}", strerror(errno)).c_str());
  } catch (const UsageError& error) {
    return left_with(kUsage, program, error.what());
  } catch (const std::exception& error) {
    return left_with(kWorse, program, reason_of(error).c_str());
  }
}

}  // namespace

int main(int count, char** arguments, const std::function<benchmarks::Catalog()>& catalog,
         const SourceTree& tree) {
  open_standard_streams();
  prepare_libraries(arguments);
  benchmarks::ignore_signals_of_children();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is a write that fails, and says so
  if (!tree.commit.empty()) set_program_tree(tree.commit, tree.is_dirty);
  benchmarks::set_program_sources(tree.sources);
  const std::string program = std::filesystem::path(arguments[0]).filename().string();
  benchmarks::Session session(command_of(program, count, arguments), catalog);
  const int code = code_of(program, count, arguments, session);
  if (session.plugins().empty()) return code;
  _exit(code);  // what a library does when it is unloaded costs nothing that is done
}

}  // namespace isoline
