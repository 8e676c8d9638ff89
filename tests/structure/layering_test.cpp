// Layering: which folder may include which, which file is the only adapter to a library or prints,
// and how many files may parse each heavy header, since compile time is a feature.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include "tests/structure/sources.h"

namespace isoline {
namespace {

using Set = std::set<std::string>;

struct Include {
  std::string name;
  bool is_quoted;
};

// The includes of every file of ours, read once.
const std::map<std::string, std::vector<Include>>& included() {
  static const std::map<std::string, std::vector<Include>> all = [] {
    static const std::regex pattern(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
    std::map<std::string, std::vector<Include>> found;
    for (const Source& source : sources()) {
      std::vector<Include>& own = found[source.path];
      std::smatch match;
      for (const std::string& line : source.lines)
        if (std::regex_search(line, match, pattern)) own.push_back({match[2], match[1] == "\""});
    }
    return found;
  }();
  return all;
}

const std::vector<Include>& includes_of(const Source& source) { return included().at(source.path); }

// How a source reaches a header of a library whose name begins so: the source, headers of ours,
// then that header; nothing where it does not. The shortest way counts.
std::optional<std::vector<std::string>> way_to(const Source& source, const std::string& header) {
  std::map<std::string, std::string> from = {{source.path, ""}};  // by whom each was included
  std::deque<std::string> open = {source.path};
  for (; !open.empty(); open.pop_front()) {
    const std::string file = open.front();
    if (!included().contains(file)) continue;  // generated
    for (const Include& include : included().at(file)) {
      if (include.is_quoted) {
        if (from.emplace(include.name, file).second) open.push_back(include.name);
      } else if (include.name.starts_with(header)) {
        std::vector<std::string> way = {include.name};
        for (std::string at = file; !at.empty(); at = from.at(at)) way.push_back(at);
        std::ranges::reverse(way);
        return way;
      }
    }
  }
  return std::nullopt;
}

// A folder may include itself and these; a file's name stands for that header alone.
const std::map<std::string, Set> kAllowed = {
    {"core", {}},
    {"core/foreign", {"core"}},
    {"core/records", {"core", "core/foreign", "core/records/parts"}},
    {"core/records/parts", {"core", "core/records/part.h", "core/records/npy.h"}},
    {"core/results", {"core", "core/records"}},
    {"networks", {"core", "networks/unet"}},
    {"networks/unet", {"core", "networks/network.h"}},
    {"problems", {"core", "core/foreign", "core/records/npy.h", "networks", "problems/physics"}},
    {"problems/physics",
     {"core", "core/foreign", "problems/physics.h", "problems/random_fields.h"}},
    {"optimizers", {"core", "core/foreign", "problems/problem.h", "problems/problem_entry.h"}},
    {"benchmarks/plan", {"core", "core/foreign", "core/records", "problems", "optimizers"}},
    {"benchmarks/run",
     {"core", "core/foreign", "core/records", "core/results", "problems", "optimizers",
      "benchmarks/plan", "benchmarks/run/keepers"}},
    {"benchmarks/run/keepers", {"core", "core/records", "core/records/parts", "optimizers"}},
    {"benchmarks/audit",
     {"core", "core/records", "core/results", "problems", "optimizers", "benchmarks/plan",
      "benchmarks/run", "benchmarks/run/keepers/keeper.h"}},
    {"benchmarks/merge", {"core", "core/records", "benchmarks/run/process_group.h"}},
    {"benchmarks/shard",
     {"core", "core/records", "problems", "optimizers", "benchmarks/plan", "benchmarks/run"}},
    {"reports/sections", {"core", "core/records", "core/results"}},
    {"reports/formats", {"core", "core/records", "core/results", "reports/sections"}},
    {"reports/page",
     {"core", "core/records", "core/results", "reports/sections", "reports/formats"}},
    {"reports/compare",
     {"core", "core/records", "core/results", "reports/sections", "reports/formats"}},
    {"reports", {"core", "core/results", "reports/sections", "reports/formats", "reports/page"}}};

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

TEST(Layering, EveryFileStandsInTheNamespaceOfItsRoom) {
  static const std::regex opening(R"re(^(?:inline )?namespace ([\w:]+) \{)re");
  for (const Source& source : sources()) {
    if (source.is_test() || source.path == "core/foreign/isoline.h") continue;  // in C
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
    {"suitesparse/", R"((core/sparse|optimizers/libdogleg)\.cpp)"},
    {"openblas_config.h", R"(core/(decompose|threads)\.cpp)"},
    {"cblas.h", R"(core/(product|threads)\.cpp|benchmarks/micro/.*\.cpp)"},
    {"oneapi/dnnl/", R"(core/convolution\.cpp)"},
    {"omp.h", R"(core/threads\.cpp)"},
    {"Random123/", R"(core/random\.cpp)"},
    {"simdjson.h", R"(core/records/json_view\.(h|cpp))"},
    {"valijson/", R"(core/records/json_view\.cpp)"},
    {"zlib.h", R"(core/compress\.cpp)"},
    {"ceres/", R"(optimizers/ceres(_tiny)?\.cpp|benchmarks/micro/.*\.cpp)"},
    {"glog/", R"(optimizers/ceres\.cpp|benchmarks/micro/.*\.cpp)"},
    {"cminpack.h", R"(optimizers/minpack\.cpp)"},
    {"gsl/", R"(optimizers/gsl\.cpp)"},
    {"dogleg.h", R"(optimizers/libdogleg\.cpp)"},
    {"nlopt.h", R"(optimizers/nlopt\.cpp|benchmarks/micro/.*\.cpp)"},
    {"CLI/", R"(benchmarks/cli/command_line\.cpp|tests/reports/records/main\.cpp)"},
    {"benchmark/", R"(benchmarks/micro/.*)"},
    {"gtest/", R"(tests/.*)"},
    {"fmt/", R"(.*\.cpp)"},
    {"nlohmann/json_fwd.hpp", R"(.*)"},
    {"nlohmann/json.hpp", R"(.*\.cpp|core/records/fields\.h|tests/.*)"},
    {"Eigen/Core", R"((?!reports/|core/records/|core/results/).*)"},
    {"Eigen/",
     R"((?!reports/|core/records/|core/results/).*\.cpp)"}};  // heavy headers stay out of ours

// Headers of C++ have no dot; these are the operating system's.
bool is_system(const std::string& header) {
  static const Set known = {"unistd.h",    "poll.h",       "fcntl.h",  "fnmatch.h",
                            "stdlib.h",    "strings.h",    "stdint.h", "cpuid.h",
                            "x86intrin.h", "dlfcn.h",      "malloc.h", "spawn.h",
                            "arpa/inet.h", "netinet/in.h", "sched.h",  "gnu/libc-version.h"};
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

// --- text that others wrote leaves by one function: what reaches a terminal is printable, and what
// becomes JSON is valid

bool is_product(const Source& source) {
  return !source.is_test() && !source.path.starts_with("benchmarks/micro/");
}

Set users_of(const std::regex& call) {
  Set users;
  for (const Source& source : sources())
    for (const std::string& line : source.lines)
      if (is_product(source) && std::regex_search(without_comment(line), call))
        users.insert(source.path);
  return users;
}

TEST(Doors, WhatAUserReadsIsSaidByOneFunction) {
  const std::regex printing(
      R"(\bfmt::print\b|\bstd::(cout|cerr|clog|puts|printf|fprintf|fputs|perror)\b|\bfwrite\b)");
  EXPECT_EQ(users_of(printing), (Set{"benchmarks/run/progress.cpp", "core/text.cpp"}))
      << "say(stdout, …) of core/text.h prints; the live line clears itself besides";
}

TEST(Doors, JsonIsWrittenByOneFunction) {
  EXPECT_EQ(users_of(std::regex(R"((\.|->)dump\()")), Set{"core/json.cpp"})
      << "json_text of core/json.h never throws on text";
}

// --- heavy headers, parsed directly or through ours

struct HeavyHeader {
  std::string name;   // or how its name begins
  std::string files;  // which of ours are counted
  std::size_t most;
  std::string reason;  // for that number
};

const std::string kProduct = "(?!tests/|benchmarks/micro/).*";
const std::string kTests = "(tests|benchmarks/micro)/.*";

const std::vector<HeavyHeader> kHeavyHeaders = {
    {"CLI/", kProduct, 1, "the command line is read in one file"},
    {"nlohmann/json.hpp", kProduct, 63, "files that read or write JSON themselves"},
    {"nlohmann/json.hpp", kTests, 73, "tests that look into JSON or make it"},
    {"simdjson.h", kProduct, 1, "JSON is read by the hundred thousand through one view"},
    {"valijson/", ".*", 1, "schemas are checked in one file"},
    {"Eigen/", "reports/.*", 0, "a report holds plain numbers"},
    {"Eigen/", "core/records/.*", 0, "records and sheets hold plain numbers"},
    {"Eigen/", "benchmarks/(cli|verbs)/.*", 3,
     "check, infer and train compute; other verbs do not"},
    {"Eigen/SVD", kProduct, 0, "decompositions are LAPACK's, in core/decompose.cpp"},
    {"Eigen/Dense", ".*", 0, "the same"},
    {"fmt/ranges.h", ".*", 15, "texts that join lists; fmt/format.h does for all else"},
    {"fmt/chrono.h", ".*", 0, "instants are those of core/clock.h"},
    {"ceres/", kProduct, 2, "one adapter, and one of the small header of TinySolver"},
    {"oneapi/dnnl/", kProduct, 1, "one adapter"},
    {"regex", kProduct, 0, "its matches recurse, a level a character: texts are read by hand"}};

TEST(HeavyHeaders, AreParsedByNoMoreFilesThanNeedThem) {
  for (const HeavyHeader& header : kHeavyHeaders) {
    const std::regex counted(header.files);
    std::size_t count = 0;
    std::ostringstream ways;
    for (const Source& source : sources()) {
      if (source.is_header() || !std::regex_match(source.path, counted)) continue;
      const auto way = way_to(source, header.name);
      if (!way) continue;
      ++count;
      ways << "\n ";
      for (const std::string& file : *way) ways << " -> " << file;
    }
    EXPECT_LE(count, header.most) << header.name << " in " << header.files << " (" << header.reason
                                  << "): include a lighter header, or raise the number"
                                  << ways.str();
    RecordProperty("parsed " + header.name + " in " + header.files, int(count));
  }
}

// The reader of includes follows headers: else every count above would be 0.
TEST(HeavyHeaders, AreFoundThroughOurOwnHeaders) {
  std::size_t direct = 0, all = 0;
  for (const Source& source : sources()) {
    const auto way = way_to(source, "Eigen/Core");
    if (!way || source.is_header()) continue;
    ++all;
    direct += way->size() == 2;
  }
  EXPECT_GT(all, 100U);
  EXPECT_LT(direct, all / 2);
}

}  // namespace
}  // namespace isoline
