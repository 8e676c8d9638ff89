// Digests of sources, looked up by file and joined to that of a build.
#include "benchmarks/plan/build_parts.h"

#include <sstream>

#include "core/files.h"
#include "core/records/provenance.h"

namespace isoline::benchmarks {
namespace {

using Digests = std::map<std::string, std::string>;

Digests& program_sources() {
  static Digests all;
  return all;
}

// A compiler names a file from wherever it was called: "/home/me/isoline/problems/heat.cpp".
const std::string* found_in(const Digests& digests, const std::string& file) {
  for (std::size_t begin = 0; begin != std::string::npos;) {
    const auto found = digests.find(file.substr(begin));
    if (found != digests.end()) return &found->second;
    begin = file.find('/', begin);
    if (begin != std::string::npos) ++begin;
  }
  return nullptr;
}

const std::string& program_digest() {
  static const std::string found = digest(read_text("/proc/self/exe"));
  return found;
}

}  // namespace

void set_program_sources(std::string_view lines) {
  std::istringstream in{std::string(lines)};
  for (std::string file, one; in >> file >> one;) program_sources()[file] = one;
}

std::string source_digest(const std::string& file) {
  if (const std::string* own = found_in(program_sources(), file)) return *own;
  if (const std::string* ours = found_in(tree_sources(), file)) return *ours;
  return program_digest();
}

BuildParts build_parts(const Request& request) {
  const Component &problem = request.problem, &optimizer = request.optimizer;
  BuildParts parts{
      {"platform", platform_digest()},
      {"harness", tree_sources().at("harness")},
      {"problem", problem.sources},
      {"optimizer", problem.is_learned ? optimizer.learning_sources : optimizer.sources}};
  if (problem.is_learned) parts["network"] = problem.learning_sources;
  return parts;
}

std::string build_digest(const Request& request) {
  std::string text;
  for (const auto& [part, one] : build_parts(request))
    text.append(part).append(" ").append(one).append("\n");
  return digest(text);
}

}  // namespace isoline::benchmarks
