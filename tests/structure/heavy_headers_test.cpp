// Compile time is a feature: how many files may parse each heavy header, directly or through ours.
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "tests/structure/includes.h"

namespace isoline {
namespace {

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
    {"ceres/", kProduct, 1, "one adapter"},
    {"oneapi/dnnl/", kProduct, 1, "one adapter"},
    {"regex", kProduct, 0, "its matches recurse, a level a character: texts are read by hand"}};

std::string chain(const std::vector<std::string>& way) {
  std::string text;
  for (const std::string& file : way) text += (text.empty() ? "" : " -> ") + file;
  return text;
}

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
      ways << "\n  " << chain(*way);
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
