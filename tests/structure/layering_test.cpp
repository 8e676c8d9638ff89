// Layering: which folder may include which, and which file is the only adapter to a
// library.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>

#include "tests/structure/includes.h"

namespace isoline {
namespace {

using Set = std::set<std::string>;

// A folder may include itself and these; a file's name stands for that header alone.
const std::map<std::string, Set> kAllowed = {
    {"core", {}},
    {"core/foreign", {"core"}},
    {"core/records", {"core", "core/foreign"}},
    {"core/results", {"core", "core/records"}},
    {"networks", {"core", "networks/unet"}},
    {"networks/unet", {"core", "networks/network.h"}},
    {"problems", {"core", "core/foreign", "core/records/npy.h", "networks", "problems/physics"}},
    {"problems/physics",
     {"core", "core/foreign", "problems/physics.h", "problems/random_fields.h"}},
    {"optimizers", {"core", "core/foreign", "problems/problem.h", "problems/problem_entry.h"}},
    {"benchmarks/plan", {"core", "core/foreign", "core/records", "problems", "optimizers"}},
    {"benchmarks/run",
     {"core", "core/foreign", "core/records", "problems", "optimizers", "benchmarks/plan"}},
    {"benchmarks/audit",
     {"core", "core/records", "problems", "optimizers", "benchmarks/plan", "benchmarks/run"}},
    {"benchmarks/merge", {"core", "core/records"}},
    {"benchmarks/shard",
     {"core", "core/records", "problems", "optimizers", "benchmarks/plan", "benchmarks/run"}},
    {"reports/read", {"core", "core/records", "core/results"}},
    {"reports/sections", {"core", "core/records", "reports/read", "core/results"}},
    {"reports/formats", {"core", "core/records", "core/results", "reports/sections"}},
    {"reports/page",
     {"core", "core/records", "core/results", "reports/read", "reports/sections",
      "reports/formats"}},
    {"reports/compare",
     {"core", "core/records", "reports/read", "core/results", "reports/sections",
      "reports/formats"}},
    {"reports",
     {"core", "core/results", "reports/read", "reports/sections", "reports/formats",
      "reports/page"}}};

// These see every room.
bool is_free(const std::string& folder) {
  return folder == "benchmarks/cli" || folder == "benchmarks/verbs" ||
         folder == "benchmarks/micro" || folder.starts_with("tests");
}

std::string folder_of(const std::string& header) { return header.substr(0, header.rfind('/')); }

// The row of a folder: its own, or that of the folder above.
const Set& allowed_to(const std::string& folder) {
  static const Set nothing;
  if (const auto row = kAllowed.find(folder); row != kAllowed.end()) return row->second;
  const std::size_t above = folder.rfind('/');
  return above == std::string::npos ? nothing : allowed_to(folder.substr(0, above));
}

bool is_allowed(const Source& source, const std::string& header) {
  const std::string from = source.folder(), to = folder_of(header);
  if (is_free(from)) return true;
  const Set& allowed = allowed_to(from);
  return from == to || allowed.contains(to) || allowed.contains(header);
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

// A folder is above all that it may include: the table itself has no circle. Single headers are
// left out: by them a room below sees an interface of the one above.
TEST(Layering, TheTableHasNoCircle) {
  std::map<std::string, Set> left = kAllowed;
  for (std::size_t before = 0; before != left.size();) {
    before = left.size();
    std::erase_if(left, [&](const auto& row) {
      return std::ranges::none_of(row.second, [&](const auto& to) { return left.contains(to); });
    });
  }
  for (const auto& [folder, allowed] : left) ADD_FAILURE() << folder << " stands in a circle";
}

TEST(Layering, AHeaderNamedWithoutAFolderIsANeighbourOrGenerated) {
  for (const Source& source : sources())
    for (const Include& include : includes_of(source)) {
      if (!include.is_quoted || include.name.find('/') != std::string::npos) continue;
      const bool is_neighbour =
          std::filesystem::exists((root() / source.path).parent_path() / include.name);
      EXPECT_TRUE(is_neighbour || include.name.starts_with("isoline_"))
          << source.path << " includes " << include.name;
    }
}

// --- namespaces: one a room, so that two rooms may both have a Point

// isoline::main() alone is named without its room, for programs of other repositories.
bool declares_main(const Source& source) {
  return source.path == "benchmarks/cli/program.h" || source.path == "benchmarks/cli/program.cpp";
}

// The types of CLI11 that the verbs' interface names, without its headers.
bool declares_parser(const Source& source) { return source.path == "benchmarks/cli/verb.h"; }

bool is_in_c(const Source& source) { return source.path == "core/foreign/isoline.h"; }

TEST(Layering, EveryFileStandsInTheNamespaceOfItsRoom) {
  static const std::regex opening(R"re(^(?:inline )?namespace ([\w:]+) \{)re");
  for (const Source& source : sources()) {
    if (source.is_test() || is_in_c(source)) continue;
    const std::string own = source.folder() == "core/results" ? "isoline::results"
                            : source.room() == "core"         ? "isoline"
                                                              : "isoline::" + source.room();
    bool has_own = source.text.find("\nint main(") != std::string::npos;
    std::smatch match;
    for (const std::string& line : source.lines) {
      if (!std::regex_search(line, match, opening)) continue;
      const std::string name = match[1];
      const bool is_own = name == own || (name.starts_with(own + "::") && own != "isoline") ||
                          (name == "isoline" && declares_main(source)) ||
                          (name == "CLI" && declares_parser(source));
      EXPECT_TRUE(is_own) << source.path << ": " << line;
      has_own = has_own || is_own;
    }
    EXPECT_TRUE(has_own) << source.path << " has no namespace " << own;
  }
}

// --- libraries

// A library's headers, by the beginning of their name, and the files that may include them.
// benchmarks/micro measures against the libraries themselves.
const std::vector<std::pair<std::string, std::string>> kDoors = {
    {"fftw3.h", R"(core/fourier\.cpp|benchmarks/micro/.*\.cpp)"},
    {"lapacke.h", R"(core/decompose\.cpp|benchmarks/micro/.*\.cpp)"},
    {"openblas_config.h", R"(core/(decompose|threads)\.cpp)"},
    {"cblas.h", R"(core/(product|threads)\.cpp|benchmarks/micro/.*\.cpp)"},
    {"oneapi/dnnl/", R"(core/convolution\.cpp|benchmarks/micro/.*\.cpp)"},
    {"omp.h", R"(core/threads\.cpp)"},
    {"Random123/", R"(core/random\.cpp)"},
    {"simdjson.h", R"(core/records/json_view\.(h|cpp))"},
    {"valijson/", R"(core/records/schema\.cpp)"},
    {"ceres/", R"(optimizers/ceres\.cpp|benchmarks/micro/.*\.cpp)"},
    {"glog/", R"(optimizers/ceres\.cpp|benchmarks/micro/.*\.cpp)"},
    {"nlopt.h", R"(optimizers/nlopt\.cpp|benchmarks/micro/.*\.cpp)"},
    {"CLI/", R"(benchmarks/cli/command_line\.cpp|tests/reports/records/main\.cpp)"},
    {"benchmark/", R"(benchmarks/micro/.*)"},
    {"gtest/", R"(tests/.*)"},
    {"fmt/", R"(.*\.cpp)"},
    {"nlohmann/json_fwd.hpp", R"(.*)"},
    {"nlohmann/json.hpp", R"(.*\.cpp|tests/.*)"},
    {"Eigen/Core", R"((?!reports/|core/records/|core/results/).*)"},
    {"Eigen/",
     R"((?!reports/|core/records/|core/results/).*\.cpp)"}};  // heavy headers stay out of ours

// Headers of C++ have no dot; these are the operating system's.
bool is_system(const std::string& header) {
  static const Set known = {"unistd.h",  "poll.h",   "fcntl.h",     "fnmatch.h",   "stdlib.h",
                            "strings.h", "stdint.h", "cpuid.h",     "x86intrin.h", "dlfcn.h",
                            "malloc.h",  "spawn.h",  "arpa/inet.h", "netinet/in.h"};
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
                                    << ">: name its adapter here and in the conventions";
      EXPECT_TRUE(std::regex_match(source.path, std::regex(door->second)))
          << source.path << " includes <" << include.name << ">";
    }
}

}  // namespace
}  // namespace isoline
