// CITATION.cff names this very version, in the form that CFF 1.2.0 has.
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/files.h"
#include "core/records/provenance.h"

namespace isoline {
namespace {

// The members of the document itself, as far as they stand on one line: those within lists and
// folded texts are indented.
std::map<std::string, std::string> members() {
  std::istringstream text(read_text(std::filesystem::path(ISOLINE_SOURCE_DIR) / "CITATION.cff"));
  std::map<std::string, std::string> all;
  static const std::regex member(R"re(^([a-z-]+):(?: (.+))?$)re");
  std::smatch match;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with(' ')) continue;
    EXPECT_TRUE(std::regex_match(line, match, member)) << line;
    EXPECT_TRUE(all.emplace(match[1], match[2]).second) << line << " stands twice";
  }
  return all;
}

TEST(Citation, IsOfThisVersion) { EXPECT_EQ(members()["version"], version()); }

// The schema of CFF 1.2.0: what it requires, and all that it allows of what we use.
TEST(Citation, HasTheMembersThatTheFormatRequires) {
  const auto all = members();
  for (const char* required : {"authors", "cff-version", "message", "title"})
    EXPECT_TRUE(all.contains(required)) << required;
  EXPECT_EQ(all.at("cff-version"), "1.2.0");
  EXPECT_EQ(all.at("type"), "software");
  EXPECT_EQ(all.at("license"), "MIT");
  std::istringstream words(
      "abstract authors cff-version commit contact date-released doi identifiers keywords license "
      "license-url message preferred-citation references repository repository-artifact "
      "repository-code title type url version");
  const std::set<std::string> allowed{std::istream_iterator<std::string>(words), {}};
  for (const auto& [name, value] : all) EXPECT_TRUE(allowed.contains(name)) << name;
}

}  // namespace
}  // namespace isoline
