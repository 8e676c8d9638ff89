// What answered: version, commit, compiler, processor, libraries.
#include "core/records/provenance.h"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "core/decompose.h"
#include "core/json.h"
#include "isoline_build_flags.h"
#include "isoline_build_info.h"

namespace isoline {
namespace {

constexpr int kHarnessRevision = 1;  // raised when the run loop or the meter changes results

// The value of `key` in a file of "key<separator>value" lines, or "unknown".
std::string value_in(const char* path, const std::string& key, char separator) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const auto start = line.find_first_not_of("\t \"", line.find(separator) + 1);
    const auto end = line.find_last_not_of("\t \"");
    if (start != std::string::npos) return line.substr(start, end - start + 1);
  }
  return "unknown";
}

std::string instruction_set() {
  std::string set = ISOLINE_MARCH;
#ifdef __AVX2__
  set += " avx2";
#endif
#ifdef __FMA__
  set += " fma";
#endif
#ifdef __AVX512F__
  set += " avx512f";
#endif
  return set;
}

Json libraries() {
  Json versions = Json::object();
  std::istringstream list(ISOLINE_LIBRARIES);  // "Name version;Name version"
  for (std::string library; std::getline(list, library, ';');)
    versions[library.substr(0, library.find(' '))] = library.substr(library.find(' ') + 1);
  versions["OpenBLAS"] = lapack_library();
  return versions;
}

std::string system_name() {
  utsname kernel{};
  uname(&kernel);
  return fmt::format("{}, {} {}", value_in("/etc/os-release", "PRETTY_NAME", '='), kernel.sysname,
                     kernel.release);
}

Json read_provenance() {
  return {{"version", version()},
          {"commit", kCommit},
          {"dirty", kDirty},
          {"compiler", "g++ " __VERSION__},
          {"build_type", ISOLINE_BUILD_TYPE},
          {"flags", ISOLINE_FLAGS},
          {"instruction_set", instruction_set()},
          {"processor", value_in("/proc/cpuinfo", "model name", ':')},
          {"cores", std::thread::hardware_concurrency()},
          {"system", system_name()},
          {"libraries", libraries()}};
}

}  // namespace

std::string version() { return ISOLINE_VERSION; }

const Json& provenance() {
  static const Json read = read_provenance();
  return read;
}

std::string build_digest(int problem_revision, int optimizer_revision) {
  const Json& all = provenance();
  return digest(fmt::format("{} {} {} {} {}", kHarnessRevision, problem_revision,
                            optimizer_revision, all.at("libraries").dump(),
                            all.at("instruction_set").get<std::string>()));
}

}  // namespace isoline
