// What another program says of itself is held to its law, and what breaks it is quoted.
#include "core/foreign/handshake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"

namespace isoline {
namespace {

Json a_problem() {
  return {{"protocol", 1},
          {"role", "problem"},
          {"name", "spring"},
          {"inputs", 2},
          {"outputs", 3},
          {"oracles", {"forward", "pullback"}},
          {"start", {1, 2}},
          {"target", {0, 0.5, "inf"}},
          {"interpreter", "CPython 3.11.2"},
          {"packages", {{"numpy", "1.24.2"}}}};
}

// The complaint about a problem that says something else in one member.
std::string complaint(const std::string& member, const Json& value) {
  Json json = a_problem();
  json[member] = value;
  try {
    problem_handshake(json_text(json), "`mine`");
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(Handshakes, OfAProblemSayWhatItIs) {
  const ProblemHandshake said = problem_handshake(json_text(a_problem()), "`mine`");
  EXPECT_EQ(said.inputs, 2);
  EXPECT_EQ(said.outputs, 3);
  EXPECT_TRUE(said.oracles.contains(Oracle::pullback));
  EXPECT_FALSE(said.oracles.contains(Oracle::pushforward));
  EXPECT_TRUE(std::isinf(said.target[2])) << "what is not finite is data";
  EXPECT_EQ(said.foreign.label, "spring");
  EXPECT_EQ(said.foreign.packages.at("numpy"), "1.24.2");
  EXPECT_EQ(said.inverse, "");
  EXPECT_FALSE(said.minimum);
}

TEST(Handshakes, ThatBreakTheLawAreQuoted) {
  EXPECT_EQ(complaint("inputs", -3),
            "`mine` says inputs = -3, which must be a whole number in [1, 134217728]");
  EXPECT_EQ(complaint("inputs", 18446744073709551615ULL),
            "`mine` says inputs = 18446744073709551615, which must be a whole number in "
            "[1, 134217728]");
  EXPECT_EQ(complaint("outputs", 2.5),
            "`mine` says outputs = 2.5, which must be a whole number in [1, 134217728]");
  EXPECT_EQ(complaint("start", {1, 2, 3}),
            "`mine` says start = [1,2,3], which must be a list of 2 numbers");
  EXPECT_EQ(complaint("target", {1, 2, "three"}),
            "`mine` says target = [1,2,\"three\"], which must be a list of 3 numbers");
  EXPECT_EQ(complaint("target", nullptr), "`mine` lacks target, a list of 3 numbers");
  EXPECT_EQ(complaint("oracles", {"forward", "gradient"}),
            "`mine` says oracles = [\"forward\",\"gradient\"], which must be a list of "
            "forward pushforward pullback jacobian inverse");
  EXPECT_EQ(complaint("name", {1}), "`mine` says name = [1], which must be text");
  EXPECT_EQ(complaint("packages", {{"numpy", 1}}),
            "`mine` says packages = {\"numpy\":1}, which must be an object of texts");
  EXPECT_EQ(complaint("inverse", "perfect"),
            "`mine` says inverse = \"perfect\", which must be one of exact damped estimate "
            "approximate");
  EXPECT_EQ(complaint("minimum", "small"),
            "`mine` says minimum = \"small\", which must be a number");
}

TEST(Handshakes, OfAnotherProtocolOrRoleAreRefused) {
  EXPECT_EQ(complaint("protocol", 2), "`mine` uses protocol 2, but this program needs 1");
  EXPECT_EQ(complaint("role", "optimizer"), "`mine` is an optimizer, but is used as a problem");
  for (const char* text : {"", "[]", "{", "nonsense", "3"})
    EXPECT_THROW(problem_handshake(text, "`mine`"), UsageError) << text;
  EXPECT_THROW(problem_handshake(std::string(100'000, '['), "`mine`"), UsageError);
}

TEST(Handshakes, BoundsLieOneBelowTheOtherAndHoldEveryPointThatIsSaid) {
  const std::string law =
      ", which must be two lists of 2 numbers, the lower bounds below the upper ones";
  for (const Json& wrong : {Json{{0, 1}, {0, 1}}, Json{{0, 0}, {1, "nan"}}, Json{{0, 0}},
                            Json{{0}, {1}}, Json("none"), Json{{0, 0}, {1, "one"}}})
    EXPECT_EQ(complaint("bounds", wrong), "`mine` says bounds = " + json_text(wrong) + law);
  Json json = a_problem();
  json["start"] = {1, 2};
  json["bounds"] = {{"-inf", 2}, {1, "inf"}};
  const ProblemHandshake said = problem_handshake(json_text(json), "`mine`");
  EXPECT_EQ(said.lower, (std::vector<Real>{-std::numeric_limits<Real>::infinity(), 2}));
  EXPECT_EQ(said.upper, (std::vector<Real>{1, std::numeric_limits<Real>::infinity()}));
  EXPECT_TRUE(said.foreign.note.ends_with("It has no value outside its bounds on x."));
  json["truth"] = {2, 2};
  try {
    problem_handshake(json_text(json), "`mine`");
    FAIL() << "a truth without";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "`mine` declares a truth outside its bounds");
  }
}

TEST(Handshakes, AnInverseAndItsKindBelongTogether) {
  EXPECT_NE(complaint("inverse", "exact"), "");
  Json json = a_problem();
  json["oracles"].push_back("inverse");
  EXPECT_THROW(problem_handshake(json_text(json), "`mine`"), UsageError);
  json["inverse"] = "damped";
  EXPECT_EQ(problem_handshake(json_text(json), "`mine`").inverse, "damped");
}

TEST(Handshakes, WhoSeeksXSaysWhich) {
  EXPECT_EQ(complaint("aim", "x"), "`mine` has the success criterion x, but truth is missing");
}

TEST(Handshakes, OfAnOptimizerSayWhatItAsks) {
  const Json json{
      {"protocol", 1}, {"role", "optimizer"}, {"needs", {"jacobian"}}, {"least_squares", true}};
  const MethodHandshake said = method_handshake(json_text(json), "`mine`");
  EXPECT_TRUE(said.needs.contains(Oracle::forward) && said.needs.contains(Oracle::jacobian));
  EXPECT_FALSE(said.needs.contains(Oracle::pullback));
  EXPECT_TRUE(said.is_least_squares);
  EXPECT_FALSE(said.reports);
  Json bad = json;
  bad["needs"] = {"truth"};
  EXPECT_THROW(method_handshake(json_text(bad), "`mine`"), UsageError) << "it is a privilege";
}

}  // namespace
}  // namespace isoline
