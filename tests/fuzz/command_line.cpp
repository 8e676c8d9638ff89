// The command line: an argument a line. No verb is run.
#include <vector>

#include "benchmarks/cli/verb.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {
namespace {

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

void command_line(std::string_view bytes) {
  std::vector<std::string> arguments = arguments_of(bytes);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  const int count = static_cast<int>(pointers.size());
  pointers.push_back(nullptr);
  expect_read_or_refused([&] { benchmarks::parse_only("isoline", count, pointers.data()); });
}

}  // namespace isoline::fuzz
