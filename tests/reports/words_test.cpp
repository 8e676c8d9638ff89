// The sentences of reports/words/: each is well formed, and sources use all of them and no others.
#include "reports/sections/words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <stdexcept>

#include "core/files.h"

namespace isoline::reports {
namespace {

TEST(Words, FillTheNamesThatTheirKeysDeclare) {
  for (const auto& [key, sentence] : all_sentences()) {
    const bool has_format = sentence.text.find(':', sentence.text.find('{')) != std::string::npos;
    const Value one = has_format ? Value(Real{1}) : Value(std::int64_t{1});
    EXPECT_NO_THROW(filled(key, std::vector<Value>(sentence.names.size(), one))) << key;
    EXPECT_EQ(sentence.text.find("  "), std::string::npos) << key;
  }
}

TEST(Words, FollowCountsAndFormats) {
  EXPECT_EQ(words("remarks.unreadable", 1), "Unreadable: 1 file, listed under failures.");
  EXPECT_EQ(words("remarks.unreadable", 2), "Unreadable: 2 files, listed under failures.");
  EXPECT_NE(words("limits.detectable", 0.0123).find(" 0.012 "), std::string::npos);
  EXPECT_EQ(worded_table("calls", "1e-6", "").columns,
            (std::vector<std::string>{"optimizer", "runs to 1e-6"}));
}

TEST(Words, WithoutSuchAKeyOrForOtherValuesAreErrors) {
  EXPECT_THROW(words("no.such.key"), std::logic_error);
  EXPECT_THROW(words("limits.detectable"), std::logic_error);
  EXPECT_THROW(words("limits.detectable", 1, 2), std::logic_error);
}

// A key is written whole in a source, or its beginning is ("column." + name), or it is a part that
// a table, a plot or a section takes by its name.
TEST(Words, AreThoseThatSourcesName) {
  std::string sources;
  for (const char* folder : {"reports/sections", "reports/page"})
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(ISOLINE_SOURCE_DIR) / folder))
      sources += read_text(entry.path());
  const auto has = [&](const std::string& text) { return sources.find(text) != std::string::npos; };
  static const std::regex part(
      R"((.+)\.(title|caption|columns|meanings|align|x|y|lead|otherwise|reading))"),
      beginning(R"(([a-z]+\.).+)");
  std::smatch match;
  for (const auto& [key, sentence] : all_sentences()) {
    const bool is_part = std::regex_match(key, match, part) && has('"' + match[1].str() + '"');
    const bool is_named = std::regex_match(key, match, beginning) && has('"' + match[1].str());
    EXPECT_TRUE(has('"' + key + '"') || is_part || is_named) << key << " is not used";
  }
  static const std::regex use(R"(words\(\s*"([a-z0-9.-]+[a-z0-9])\")");
  for (std::sregex_iterator it(sources.begin(), sources.end(), use), end; it != end; ++it)
    EXPECT_TRUE(all_sentences().contains((*it)[1].str())) << (*it)[1] << " is not there";
}

}  // namespace
}  // namespace isoline::reports
