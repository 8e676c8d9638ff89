// Text of others is valid where it comes in and harmless where it is shown; instants come back.
#include "core/text.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "core/clock.h"
#include "core/files.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

TEST(Text, ValidTextStaysToTheByte) {
  for (const std::string text : {"", "plain", "θ ↦ x̃ = P⁻¹(y)", "\U0001F600", "a\nb\tc"})
    EXPECT_EQ(valid_utf8(text), text);
}

// The examples of the Unicode standard, section 3.9, "U+FFFD substitution of maximal subparts".
TEST(Text, WhatIsNoUtf8IsReplaced) {
  const std::string broken = "\uFFFD";
  EXPECT_EQ(valid_utf8("x\xff"), "x" + broken);
  EXPECT_EQ(valid_utf8("\xC0\xAF"), broken + broken) << "overlong";
  EXPECT_EQ(valid_utf8("\xED\xA0\x80"), broken + broken + broken) << "a surrogate";
  EXPECT_EQ(valid_utf8("\xF4\x91\x92\x93"), broken + broken + broken + broken);
  EXPECT_EQ(valid_utf8("\xE1\x80\xE2\xF0\x91\x92\xF1\xBF"
                       "A"),
            broken + broken + broken + broken + "A");
  EXPECT_EQ(valid_utf8("\xCE"), broken) << "cut inside of a character";
}

TEST(Text, IsCutBetweenCharacters) {
  const std::string text = "aθ\U0001F600z";  // of 1, 2, 4 and 1 bytes
  EXPECT_EQ(cut(text, 0), "");
  EXPECT_EQ(cut(text, 1), "a");
  EXPECT_EQ(cut(text, 2), "a");
  EXPECT_EQ(cut(text, 3), "aθ");
  for (std::size_t most = 4; most < 7; ++most) EXPECT_EQ(cut(text, most), "aθ");
  EXPECT_EQ(cut(text, 7), "aθ\U0001F600");
  EXPECT_EQ(cut(text, 100), text);
  const std::string rests(10, '\x80');
  EXPECT_LE(cut(rests, 6).size(), 6U);
}

TEST(Text, EscapeSequencesAndTurnedDirectionsAreMadeVisible) {
  EXPECT_EQ(printable("\x1b[31mred\x1b]0;title\x07"), "\\u001b[31mred\\u001b]0;title\\u0007");
  EXPECT_EQ(printable("\u009b2J"), "\\u009b2J") << "a control character of the second set";
  EXPECT_EQ(printable("gd\u202exyz\u2066"), "gd\\u202exyz\\u2066");
  EXPECT_EQ(printable("over\rwritten\x7f"), "over\\u000dwritten\\u007f");
  EXPECT_EQ(printable("a\xff"), "a\uFFFD");
  for (const std::string text : {"", "two\nlines\tand θ", "sine × adam[rate=0.1]"})
    EXPECT_EQ(printable(text), text);
}

TEST(Text, IsSaidPrintable) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "said";
  std::FILE* out = std::fopen(path.c_str(), "w");
  say(out, "one \x1b[2J\n");
  std::fclose(out);
  EXPECT_EQ(read_text(path), "one \\u001b[2J\n");
}

TEST(Text, ThatCannotBeWrittenIsAnError) {
  std::FILE* full = std::fopen("/dev/full", "w");
  ASSERT_NE(full, nullptr);
  std::setvbuf(full, nullptr, _IONBF, 0);
  EXPECT_THROW(say(full, "text"), std::exception);
  std::fclose(full);
}

// The seconds by `date -u -d TEXT +%s`.
TEST(Instant, IsTheUniversalTimeOfSecondsSince1970AndNothingElse) {
  EXPECT_EQ(instant_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(instant_text(1769860800), "2026-01-31T12:00:00Z");
  EXPECT_EQ(instant_from("2024-02-29T23:59:59Z"), 1709251199);
  for (const std::int64_t seconds : {-1LL, 0LL, 951782400LL, 4102444799LL})
    EXPECT_EQ(instant_from(instant_text(seconds)), seconds) << instant_text(seconds);
  EXPECT_EQ(instant_from(instant_text(seconds_now())).value_or(0) / 100, seconds_now() / 100);
  for (const std::string& text :
       {std::string(), std::string("2026-01-31"), std::string("2026-01-31T12:00:00"),
        std::string("2026-01-31T12:00:00Z "), std::string("2026-02-31T12:00:00Z"),
        std::string("2026-1-31T12:00:00Z"), std::string("yesterday"),
        std::string("2026-01-31T25:00:00Z"), std::string("2026-01-31T12:00:00Z\0more", 25)})
    EXPECT_EQ(instant_from(text), std::nullopt) << text;
}

}  // namespace
}  // namespace isoline
