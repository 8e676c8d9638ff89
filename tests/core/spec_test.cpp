// Specs, sweeps, seeds and durations are read as the command line says.
#include "core/spec.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/errors.h"
#include "core/text.h"

namespace isoline {
namespace {

TEST(Spec, NamesAndOptionsAreSplitAtDepthZero) {
  const auto specs = parse_specs("sip[network-optimizer=adam[rate=1e-3,beta1=0.8],step=1],gd");
  ASSERT_EQ(specs.size(), 2U);
  EXPECT_EQ(specs[0].name, "sip");
  EXPECT_EQ(options_of(specs[0]).text("network-optimizer"), "adam[rate=1e-3,beta1=0.8]");
  EXPECT_EQ(options_of(specs[0]).text("step"), "1");
  EXPECT_EQ(specs[1].name, "gd");
}

TEST(Spec, BarsSweep) {
  const auto specs = parse_specs("sine[xi=1|3|10,phi=0|45]");
  ASSERT_EQ(specs.size(), 6U);
  EXPECT_EQ(options_of(specs[5]).text("xi"), "10");
  EXPECT_EQ(options_of(specs[5]).text("phi"), "45");
}

TEST(Spec, NestedBarsBelongToTheInnerSpec) {
  const auto specs = parse_specs("sip[network-optimizer=adam[rate=1|2]]");
  ASSERT_EQ(specs.size(), 1U);
  EXPECT_EQ(options_of(specs[0]).text("network-optimizer"), "adam[rate=1|2]");
}

TEST(Spec, AValueInDoubleQuotesIsAJsonStringWithLiteralCommasBarsAndBrackets) {
  const auto specs =
      parse_specs(R"(process[command="python3 a,b|c ]x[ \"q\" \u00e9",seed=1|2],gd)");
  ASSERT_EQ(specs.size(), 3U);
  EXPECT_EQ(options_of(specs[1]).text("command"), "python3 a,b|c ]x[ \"q\" é");
  EXPECT_EQ(options_of(specs[1]).text("seed"), "2");
  EXPECT_EQ(specs[2].name, "gd");
  EXPECT_EQ(parse_specs(R"(a[b="1,2"|"3|4"])").size(), 2U);
  const auto nested = parse_spec(R"(sip[network-optimizer=process[command="x,]"]])");
  EXPECT_EQ(options_of(nested).text("network-optimizer"), R"(process[command="x,]"])");
}

// Found by fuzzing: the message began with the name, and so ended before it had begun.
TEST(Spec, AZeroByteIsRefusedInWords) {
  for (const std::string& text :
       {std::string("\0a[b=1,b=2]", 11), std::string(R"(a[b="1\u0000"])")}) {
    std::string message;
    try {
      options_of(parse_spec(text));
    } catch (const UsageError& refusal) {
      message = refusal.what();
    }
    EXPECT_NE(message.find("a zero byte"), std::string::npos) << message;
  }
}

// Found by fuzzing: these quoted it, and the message ended there.
TEST(Spec, AZeroByteInSeedsOrATimeIsRefusedInWords) {
  const std::string given("\"\000569", 5);
  for (const auto& read : {std::function<void()>([&] { parse_seeds(given); }),
                           std::function<void()>([&] { parse_duration(given); })}) {
    std::string message;
    try {
      read();
    } catch (const UsageError& refusal) {
      message = refusal.what();
    }
    EXPECT_NE(message.find("a zero byte"), std::string::npos) << message;
  }
}

// Found by fuzzing: JSON, which quotes what a comma would split, replaced them later.
TEST(Spec, BytesThatAreNotUtf8AreReplacedOnEntry) {
  const std::string value = parse_spec("a[b=\xff\"1,2\"]").options.at(0).second;
  EXPECT_EQ(value, "\uFFFD\"1,2\"");
  EXPECT_EQ(parse_spec("a[b=" + quoted(value) + "]").options.at(0).second, value);
}

TEST(Spec, AnyTextComesBackFromTheSpecThatIsMadeOfIt) {
  const OptionTable table{{"command", std::string("none"), {}, {}, ""}};
  for (const char* text :
       {"python3 mine.py", "a,b", "a|b", "[", "]", "a]b[c", "\"", "a\"b", "", " a ",
        "adam[rate=1e-3,beta1=0.8]", "\"quoted\"", "back\\slash\",", "line\n"}) {
    const std::string spec = short_spec(table, "process", {{"command", std::string(text)}});
    const auto back = parse_specs(spec);
    ASSERT_EQ(back.size(), 1U) << spec;
    EXPECT_EQ(options_of(back[0]).text("command"), text) << spec;
  }
  const OptionValues plain{{"command", std::string("adam[rate=1e-3,beta1=0.8]")}};
  EXPECT_EQ(short_spec(table, "sip", plain), "sip[command=adam[rate=1e-3,beta1=0.8]]");
}

TEST(Spec, AnAliasIsReadAsTheOptionItStandsFor) {
  EXPECT_EQ(options_of(parse_spec("gd[lr=2]")), options_of(parse_spec("gd[rate=2]")));
  EXPECT_THROW(options_of(parse_spec("gd[lr=1,rate=2]")), UsageError);
}

TEST(Spec, WhatDoesNotParseIsAUsageError) {
  for (const char* wrong : {"sine[", "sine]", "sine[xi]", "[xi=1]", "sine[xi=1]x", "a,,b", "",
                            "a[b=\"c]", "a[b=\"c\"d]"})
    EXPECT_THROW(parse_specs(wrong), UsageError) << wrong;
}

TEST(Seeds, CountsRangesAndSingles) {
  EXPECT_EQ(parse_seeds("3"), (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_EQ(parse_seeds("100..102"), (std::vector<std::uint64_t>{100, 101, 102}));
  EXPECT_EQ(parse_seeds("=5"), (std::vector<std::uint64_t>{5}));
  for (const char* wrong : {"0", "x", "5..2", "-1", "1.5", "0..99999999"})
    EXPECT_THROW(parse_seeds(wrong), UsageError) << wrong;
}

TEST(Seeds, TheLargestOneIsASeedLikeOthers) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(parse_seeds("=18446744073709551615"), (std::vector<std::uint64_t>{kLargest}));
  EXPECT_EQ(parse_seeds("18446744073709551614..18446744073709551615"),
            (std::vector<std::uint64_t>{kLargest - 1, kLargest}));
}

TEST(Seeds, AreCountedBeforeTheyAreListed) {
  for (const char* many : {"0..18446744073709551615", "1000001", "0..999999,=7"})
    EXPECT_THROW(parse_seeds(many), UsageError) << many;
  EXPECT_EQ(parse_seeds("0..999999").size(), 1'000'000U);
  EXPECT_THROW(parse_seeds("0..9", 9), UsageError);
}

TEST(Sweeps, AreCountedBeforeTheyAreMade) {
  std::string values = "1";
  for (int i = 1; i < 1000; ++i) values += "|1";
  const std::string sweep = fmt::format("a[x={0},y={0},z={0}],b", values);
  const std::vector<SweepSize> sizes = sweep_sizes(sweep);
  ASSERT_EQ(sizes.size(), 2U);
  EXPECT_EQ(sizes[0].settings, 1'000'000'000U);
  EXPECT_EQ(sizes[1].settings, 1U);
  try {
    parse_specs(sweep);
    FAIL() << "a billion specs were made";
  } catch (const UsageError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("1,000 of x × 1,000 of y × 1,000 of z"),
              std::string::npos)
        << refusal.what();
  }
}

// 1,000 to the power of seven is more than a count of 64 bits holds.
TEST(Sweeps, OfMoreThanCanBeCountedAreRefused) {
  std::string values = "1", sweep = "a[k=1";
  for (int i = 1; i < 1000; ++i) values += "|1";
  for (int i = 0; i < 7; ++i) sweep += fmt::format(",x{}={}", i, values);
  EXPECT_EQ(sweep_sizes(sweep + "]")[0].settings, kUncountable);
  EXPECT_THROW(parse_specs(sweep + "]"), UsageError);
}

TEST(Counts, AreWrittenInGroupsOfThree) {
  EXPECT_EQ(count_text(0), "0");
  EXPECT_EQ(count_text(999), "999");
  EXPECT_EQ(count_text(50'000), "50,000");
  EXPECT_EQ(count_text(1'000'000), "1,000,000");
}

TEST(Duration, UnitsAreRead) {
  EXPECT_EQ(parse_duration("10s"), 10);
  EXPECT_EQ(parse_duration("2m"), 120);
  EXPECT_EQ(parse_duration("1.5h"), 5400);
  EXPECT_EQ(parse_duration("250ms"), 0.25);
  EXPECT_EQ(parse_duration("3"), 3);
  for (const char* wrong : {"", "s", "-1s", "0", "1x", "inf", "nan", "1e308h", "1e10"})
    EXPECT_THROW(parse_duration(wrong), UsageError) << wrong;
}

}  // namespace
}  // namespace isoline
