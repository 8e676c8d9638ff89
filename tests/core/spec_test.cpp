// Specs, sweeps, seeds and durations are read as the command line documents; options are completed,
// checked and described as declared.
#include "core/spec.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/clock.h"
#include "core/columns.h"
#include "core/files.h"
#include "core/options.h"
#include "core/seeds.h"
#include "core/text.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

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
  const auto nested = parse_specs("sip[network-optimizer=adam[rate=1|2]]");
  ASSERT_EQ(nested.size(), 1U);
  EXPECT_EQ(options_of(nested[0]).text("network-optimizer"), "adam[rate=1|2]");
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

// Found by fuzzing: messages that quoted it ended there.
TEST(Spec, AZeroByteIsRefusedInWords) {
  for (const std::string& text :
       {std::string("\0a[b=1,b=2]", 11), std::string(R"(a[b="1\u0000"])")})
    EXPECT_NE(refusal([&] { options_of(parse_spec(text)); }).find("a zero byte"),
              std::string::npos);
  const std::string given("\"\000569", 5);
  EXPECT_NE(refusal([&] { parse_seeds(given); }).find("a zero byte"), std::string::npos);
  EXPECT_NE(refusal([&] { parse_duration(given); }).find("a zero byte"), std::string::npos);
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
  EXPECT_EQ(options_of(parse_spec("hig[way=qr]")), options_of(parse_spec("hig[factorization=qr]")));
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
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(parse_seeds("18446744073709551614..18446744073709551615"),
            (std::vector<std::uint64_t>{kLargest - 1, kLargest}));
  EXPECT_EQ(parse_seeds("0..999999").size(), 1'000'000U);
  for (const char* wrong : {"0", "x", "5..2", "-1", "1.5", "0..99999999", "0..18446744073709551615",
                            "1000001", "0..999999,=7"})  // counted before they are listed
    EXPECT_THROW(parse_seeds(wrong), UsageError) << wrong;
  EXPECT_THROW(parse_seeds("0..9", 9), UsageError);
}

TEST(Seeds, NameAnInstanceAndAStart) {
  using Seeds = std::vector<std::uint64_t>;
  EXPECT_EQ(parse_seeds("2:1,=0:3"), (Seeds{1'002'001, 1'000'003}));
  EXPECT_EQ(parse_seeds("7:7,=1007007"), (Seeds{7, 7})) << "a plain seed where both are equal";
  EXPECT_EQ(crossed_seeds("2", "=0,=2"), (Seeds{0, 1'000'002, 1'001'000, 1'001'002}));
  EXPECT_EQ(crossed_seeds("", "2"), (Seeds{0, 1'000'001}));
  for (const std::uint64_t seed :
       {0U, 3U, 999'999U, 1'002'001U, 1'000'999U, 1'999'000U, 2'000'000U}) {
    EXPECT_EQ(seed_of(instance_of(seed), start_of(seed)), seed);
    EXPECT_EQ(parse_seeds("=" + seed_text(seed)), Seeds{seed});
  }
  EXPECT_EQ(seed_text(1'002'001), "2:1");
  for (const char* wrong : {"1000:1", "1:1000", "1:", ":1", "1:2:3", "0..1:2"})
    EXPECT_THROW(parse_seeds(wrong), UsageError) << wrong;
  EXPECT_THROW(crossed_seeds("=1000", "2"), UsageError);
  EXPECT_THROW(crossed_seeds("2", "2:1"), UsageError);
}

TEST(Sweeps, AreCountedBeforeTheyAreMade) {
  std::string values = "1";
  for (int i = 1; i < 1000; ++i) values += "|1";
  const std::string sweep = fmt::format("a[x={0},y={0},z={0}],b", values);
  const std::vector<SweepSize> sizes = sweep_sizes(sweep);
  ASSERT_EQ(sizes.size(), 2U);
  EXPECT_EQ(sizes[0].settings, 1'000'000'000U);
  EXPECT_EQ(sizes[1].settings, 1U);
  EXPECT_NE(refusal([&] { parse_specs(sweep); }).find("1,000 of x × 1,000 of y × 1,000 of z"),
            std::string::npos);
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

struct Sample {
  Real rate = 0.5;
  Index count = 3;
  bool is_bold = false;
  std::string form = "code";
};
void fields(Sample& o, auto& field) {
  field("rate", o.rate, above(0), "a number");
  field("count", o.count, between(1, 10), "a whole number");
  field("bold", o.is_bold, "a switch");
  field("form", o.form, Choices{"code", "paper"}, "a choice");
}

OptionValues complete(const OptionValues& given) {
  return complete_options(option_table<Sample>(), "sample", given);
}

std::string complaint(const OptionValues& given) {
  return refusal([&] { complete(given); });
}

struct Shift {
  Real shift = 1;
};
void fields(Shift& o, auto& field) { field("shift", o.shift, between(-1, 1), "of either sign"); }

TEST(Options, AZeroHasNoSign) {
  const auto zero = [](const char* text) {
    const OptionValues all = complete_options(option_table<Shift>(), "s", {{"shift", text}});
    return all.number("shift", 1);
  };
  EXPECT_FALSE(std::signbit(zero("-0")));
  EXPECT_EQ(zero("-0.5"), -0.5);
}

TEST(Options, AreCompletedByDefaultsAndReadBack) {
  EXPECT_EQ(complete({}),
            OptionValues({{"rate", 0.5}, {"count", 3}, {"bold", false}, {"form", "code"}}));
  const auto sample = read_options<Sample>(complete({{"rate", 2}, {"form", "paper"}}));
  EXPECT_EQ(sample.rate, 2);
  EXPECT_EQ(sample.form, "paper");
  EXPECT_EQ(sample.count, 3);
  EXPECT_EQ(complete({{"rate", "1e-3"}, {"count", "7"}, {"bold", "true"}}),
            complete({{"lr", 1e-3}, {"count", 7}, {"bold", true}}));
}

TEST(Options, TheLawAndWhatWasGivenAreNamed) {
  EXPECT_TRUE(contains(decay(), 0));
  EXPECT_FALSE(contains(decay(), 1));
  EXPECT_EQ(range_text(decay()), "[0, 1)");
  EXPECT_TRUE(complaint({{"rate", -3}}).ends_with("in (0, inf), got -3"));
  EXPECT_TRUE(complaint({{"count", 11}}).ends_with("in [1, 10], got 11"));
  EXPECT_TRUE(complaint({{"count", 1.5}}).ends_with("whole number, got 1.5"));
  EXPECT_TRUE(complaint({{"rate", "fast"}}).starts_with("sample: rate must "));
  EXPECT_TRUE(complaint({{"rate", "nan"}}).ends_with("a number, got nan"));
  EXPECT_TRUE(complaint({{"rate", "inf"}}).ends_with("in (0, inf), got inf"));
  EXPECT_NE(complaint({{"rate", "1e400"}}), "");
  EXPECT_TRUE(complaint({{"bold", "maybe"}}).ends_with("true or false, got maybe"));
  EXPECT_TRUE(complaint({{"form", "papr"}}).ends_with("; did you mean paper?"));
  EXPECT_TRUE(complaint({{"rte", 1}}).ends_with("did you mean 'rate'?"));
}

TEST(Options, AreEqualInWhateverOrderTheyWereGiven) {
  OptionValues one{{"b", 2}, {"a", 1.5}};
  EXPECT_EQ(one, OptionValues({{"a", 1.5}, {"b", 2}}));
  EXPECT_NE(one, OptionValues({{"a", 1.5}, {"b", 2.0}}));  // a type is part of the value
  one.set("b", 3);
  one.erase("a");
  EXPECT_EQ(one, OptionValues({{"b", 3}}));
}

TEST(Options, SurviveTheRoundTripThroughJson) {
  const OptionValues all{{"rate", 1e-3}, {"whole", 2.0},    {"count", 7},
                         {"bold", true}, {"form", "paper"}, {"least", -INFINITY}};
  const Json json = to_json(all);
  EXPECT_EQ(json.dump(),
            R"({"bold":true,"count":7,"form":"paper","least":"-inf","rate":0.001,"whole":2.0})");
  EXPECT_EQ(to_json(option_values_from(Json::parse(json.dump()))), json);
  EXPECT_THROW(option_values_from(Json::parse(R"({"a": [1]})")), UsageError);
}

TEST(Options, ShortSpecsShowWhatDiffers) {
  const OptionTable table = option_table<Sample>();
  EXPECT_EQ(short_spec(table, "sample", complete({})), "sample");
  EXPECT_EQ(short_spec(table, "sample", complete({{"rate", 1e-3}, {"bold", true}})),
            "sample[rate=0.001,bold=true]");
}

// Foreign text is made valid when it is read and harmless when it is printed. Instants are read
// back.

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

TEST(Output, FitsATerminalBetweenWordsAndBelowTheLastColumnAndLeavesCommandsWhole) {
  EXPECT_EQ(fitted_text("one two three\n", 20), "one two three\n");
  EXPECT_EQ(fitted_text("one two three four five\nsix", 13), "one two three\nfour five\nsix");
  EXPECT_EQ(fitted_text("  rate  0.1  how far a single move may go at most", 35),
            "  rate  0.1  how far a single move\n             may go at most");
  EXPECT_EQ(fitted_text("‖x‖ ‖y‖ ‖z‖", 7), "‖x‖ ‖y‖\n‖z‖") << "letters, not bytes";
  EXPECT_EQ(fitted_text("say `isoline run quick` or so", 12), "say\n`isoline run quick`\nor so");
  for (const char* whole :
       {"  ./isoline run --problem beale --out results", "{\"a\": \"b c d e f g h\"}"})
    EXPECT_EQ(fitted_text(whole, 10), whole);
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
