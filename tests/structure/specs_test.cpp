// A spec is read by core/spec alone: components, records and sheets carry their names.
#include <gtest/gtest.h>

#include <regex>

#include "tests/structure/sources.h"

namespace isoline {
namespace {

// Looks for the bracket that opens a spec's options: '[' handed to a search, or compared with.
bool cuts_a_spec(const std::string& line) {
  static const std::regex pattern(
      R"re((find|rfind|find_first_of|find_last_of|find_if|split)\w*\([^)]*['"]\[['"])re"
      R"re(|[=!]= *'\['|'\[' *[=!]=|getline\([^)]*'\[')re");
  return std::regex_search(line, pattern);
}

TEST(Specs, AreCutInOnePlace) {
  std::size_t inside = 0;
  for (const Source& source : sources()) {
    if (source.path.starts_with("tests/")) continue;  // which read sources and scripts
    const bool is_own = source.path == "core/spec.cpp";
    for (const std::string& line : source.lines) {
      inside += is_own && cuts_a_spec(line);
      EXPECT_FALSE(!is_own && cuts_a_spec(line)) << source.path << ": " << line;
    }
  }
  EXPECT_GT(inside, 0U) << "the pattern finds nothing where there is something";
}

// How a problem is told to be learned is said where components are made, and asked nowhere else.
bool reads_the_mode(const std::string& line) {
  static const std::regex pattern(
      R"re(("mode"|"mode="|kModeOption|kLearnMode|mode ?== ?"learn"|== ?"learn"))re");
  return std::regex_search(line, pattern);
}

TEST(Specs, WhetherAComponentLearnsIsDecidedOnce) {
  const std::vector<std::string> allowed = {
      "core/options.h",             // the name
      "core/records/record.cpp",    // the decision
      "problems/",                  // the option
      "benchmarks/plan/rates.cpp",  // a row that names the mode, or does not
      "benchmarks/verbs/train",     // implied there
      "tests/"};
  for (const Source& source : sources()) {
    bool is_allowed = false;
    for (const std::string& place : allowed)
      is_allowed = is_allowed || source.path.starts_with(place);
    if (is_allowed) continue;
    for (const std::string& line : source.lines)
      EXPECT_FALSE(reads_the_mode(line)) << source.path << ": " << line;
  }
}

}  // namespace
}  // namespace isoline
