// Options are completed, checked and described as declared.
#include "core/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace isoline {
namespace {

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
  try {
    complete(given);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(Options, DefaultsAreFilledIn) {
  EXPECT_EQ(complete({}),
            OptionValues({{"rate", 0.5}, {"count", 3}, {"bold", false}, {"form", "code"}}));
}

TEST(Options, TextAndNumbersMeanTheSame) {
  EXPECT_EQ(complete({{"rate", "1e-3"}, {"count", "7"}, {"bold", "true"}}),
            complete({{"rate", 1e-3}, {"count", 7}, {"bold", true}}));
}

TEST(Options, LearningRateIsAnAliasOfRate) {
  EXPECT_EQ(complete({{"lr", 0.25}}).number("rate", 0), 0.25);
}

TEST(Options, TheStructIsReadBack) {
  const auto sample = read_options<Sample>(complete({{"rate", 2}, {"form", "paper"}}));
  EXPECT_EQ(sample.rate, 2);
  EXPECT_EQ(sample.form, "paper");
  EXPECT_EQ(sample.count, 3);
}

TEST(Options, TheLawAndWhatWasGivenAreNamed) {
  EXPECT_EQ(complaint({{"rate", -3}}), "sample: rate must be in (0, inf), got -3");
  EXPECT_EQ(complaint({{"count", 11}}), "sample: count must be in [1, 10], got 11");
  EXPECT_EQ(complaint({{"count", 1.5}}), "sample: count must be a whole number, got 1.5");
  EXPECT_EQ(complaint({{"rate", "fast"}}), "sample: rate must be a number, got fast");
  EXPECT_EQ(complaint({{"rate", "nan"}}), "sample: rate must be a number, got nan");
  EXPECT_EQ(complaint({{"bold", "maybe"}}), "sample: bold must be true or false, got maybe");
  EXPECT_EQ(complaint({{"form", "papr"}}),
            "sample: form must be one of code, paper, got papr; did you mean paper?");
  EXPECT_EQ(complaint({{"rte", 1}}), "sample: unknown option 'rte'; did you mean 'rate'?");
}

TEST(Options, ADecayIsBelowOne) {
  EXPECT_TRUE(contains(decay(), 0));
  EXPECT_FALSE(contains(decay(), 1));
  EXPECT_EQ(range_text(decay()), "[0, 1)");
}

TEST(Options, WithoutAnUpperBoundAreFiniteAllTheSame) {
  EXPECT_EQ(complaint({{"rate", "inf"}}), "sample: rate must be in (0, inf), got inf");
  EXPECT_NE(complaint({{"rate", "1e400"}}), "");
  EXPECT_NE(complaint({{"rate", "nan"}}), "");
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

}  // namespace
}  // namespace isoline
