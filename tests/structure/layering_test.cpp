// The arrows of the house: which folder may include which, and which file is whose only door to a
// library.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "tests/structure/sources.h"

namespace isoline {
namespace {

using Set = std::set<std::string>;

// A room may include itself and these; "problems/problem.h" stands for that header alone.
const std::map<std::string, Set> kAllowed = {
    {"core", {}},
    {"networks", {"core"}},
    {"problems", {"core", "networks"}},
    {"optimizers", {"core", "problems/problem.h"}},
    {"benchmarks", {"core", "problems", "optimizers"}},
    {"reports", {"core"}},
    {"tests", {"core", "networks", "problems", "optimizers", "benchmarks", "reports", "tests"}}};

struct Include {
  std::string name;
  bool is_quoted;
};

std::vector<Include> includes_of(const Source& source) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
  std::vector<Include> all;
  std::smatch match;
  for (const std::string& line : source.lines)
    if (std::regex_search(line, match, pattern)) all.push_back({match[2], match[1] == "\""});
  return all;
}

bool is_allowed(const Source& source, const std::string& header) {
  if (source.path.starts_with("benchmarks/cli/")) return true;  // the command line sees everything
  const std::string room = header.substr(0, header.find('/'));
  if (source.path.starts_with("benchmarks/micro/") && room == "networks")
    return true;  // timed alone
  const Set& allowed = kAllowed.at(source.room());
  return room == source.room() || allowed.contains(room) || allowed.contains(header);
}

TEST(Layering, EveryIncludeGoesDown) {
  std::size_t count = 0;
  for (const Source& source : sources())
    for (const Include& include : includes_of(source)) {
      if (!include.is_quoted || include.name.find('/') == std::string::npos) continue;
      EXPECT_TRUE(is_allowed(source, include.name)) << source.path << " includes " << include.name;
      ++count;
    }
  EXPECT_GT(count, 300U) << "the sources were not found";
}

TEST(Layering, AHeaderNamedWithoutAFolderIsANeighbourOrGenerated) {
  for (const Source& source : sources())
    for (const Include& include : includes_of(source)) {
      if (!include.is_quoted || include.name.find('/') != std::string::npos) continue;
      const bool is_neighbour =
          std::filesystem::exists((root() / source.path).parent_path() / include.name);
      EXPECT_TRUE(is_neighbour || include.name.starts_with("isoline_build_"))
          << source.path << " includes " << include.name;
    }
}

// A library's headers, by the beginning of their name, and the files that may include them.
// benchmarks/micro measures against the libraries themselves.
const std::vector<std::pair<std::string, std::string>> kDoors = {
    {"fftw3.h", R"(core/fourier\.cpp|benchmarks/micro/.*\.cpp)"},
    {"lapacke.h", R"(core/decompose\.cpp|benchmarks/micro/.*\.cpp)"},
    {"openblas_config.h", R"(core/decompose\.cpp)"},
    {"cblas.h", R"(core/product\.cpp|benchmarks/micro/.*\.cpp)"},
    {"oneapi/dnnl/", R"(core/convolution\.cpp|benchmarks/micro/.*\.cpp)"},
    {"omp.h", R"(core/threads\.cpp)"},
    {"Random123/", R"(core/random\.cpp)"},
    {"simdjson.h", R"(core/json_view\.(h|cpp))"},
    {"valijson/", R"(core/schema\.cpp)"},
    {"ceres/", R"(optimizers/ceres\.cpp|benchmarks/micro/.*\.cpp)"},
    {"glog/", R"(optimizers/ceres\.cpp|benchmarks/micro/.*\.cpp)"},
    {"nlopt.h", R"(optimizers/nlopt\.cpp|benchmarks/micro/.*\.cpp)"},
    {"CLI/", R"(benchmarks/cli/.*\.cpp|tests/reports/records/main\.cpp)"},
    {"benchmark/", R"(benchmarks/micro/.*)"},
    {"gtest/", R"(tests/.*)"},
    {"fmt/", R"(.*\.cpp)"},
    {"nlohmann/json_fwd.hpp", R"(.*)"},
    {"nlohmann/json.hpp", R"(.*\.cpp|core/(origin|record)\.h|tests/.*|benchmarks/micro/.*)"},
    {"Eigen/Core", R"(.*)"},
    {"Eigen/", R"(.*\.cpp)"}};  // heavy headers stay out of ours

// Headers of C++ have no dot; these are the operating system's.
bool is_system(const std::string& header) {
  static const Set known = {"unistd.h", "poll.h", "fcntl.h", "stdlib.h", "x86intrin.h", "dlfcn.h"};
  return header.find('.') == std::string::npos
             ? header.find('/') == std::string::npos
             : header.starts_with("sys/") || known.contains(header);
}

TEST(Layering, EveryLibraryStaysBehindItsDoor) {
  for (const Source& source : sources())
    for (const Include& include : includes_of(source)) {
      if (include.is_quoted || is_system(include.name)) continue;
      const auto door = std::ranges::find_if(
          kDoors, [&](const auto& each) { return include.name.starts_with(each.first); });
      ASSERT_NE(door, kDoors.end()) << source.path << " includes an unknown <" << include.name
                                    << ">: name its door here and in the conventions";
      EXPECT_TRUE(std::regex_match(source.path, std::regex(door->second)))
          << source.path << " includes <" << include.name << ">";
    }
}

}  // namespace
}  // namespace isoline
