// JSON: numbers survive; what is read without a tree is what the tree holds; what is missing or of
// another type is said.
#include "core/json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/records/json_view.h"
#include "core/records/record.h"
#include "core/text.h"
#include "tests/refusal.h"

namespace isoline {
namespace {

TEST(Numbers, SurviveTheRoundTripToTheLastBit) {
  for (const Real value : {0.1, -0.0, 1e-308, 5e-324, 1.7976931348623157e308, 1.0 / 3}) {
    const Real back = real_of(Json::parse(json_number(value).dump()));
    EXPECT_EQ(std::signbit(back), std::signbit(value));
    EXPECT_EQ(back, value);
  }
  for (const Real value : {Real{INFINITY}, -Real{INFINITY}})
    EXPECT_EQ(real_of(Json::parse(json_number(value).dump())), value);
  EXPECT_TRUE(std::isnan(real_of(Json::parse(json_number(NAN).dump()))));
  EXPECT_THROW(real_of(Json("one")), UsageError);
  EXPECT_THROW(real_of(Json()), UsageError);
}

std::string complaint_of_json(const std::string& text) {
  return refusal([&] { parse_json(text, "given.json"); });
}

// 200,000 levels overflow the stack of whoever copies, compares or writes such a tree.
TEST(Json, ThatNestsWithoutEndIsRefused) {
  for (const std::string opening : {"[", "{\"a\":"}) {
    std::string text;
    for (int i = 0; i < 200'000; ++i) text += opening;
    EXPECT_NE(complaint_of_json(text).find("nested deeper"), std::string::npos);
  }
  EXPECT_EQ(complaint_of_json("[\"[[[[\\\"[[[[\"]" + std::string(1000, ' ')), "");
  EXPECT_EQ(complaint_of_json(std::string(150, '[') + std::string(150, ']')), "");
}

TEST(Json, OfNumbersThatNoDoubleHoldsIsAUsageError) {
  EXPECT_NE(complaint_of_json("[1e400]").find("given.json"), std::string::npos);
  EXPECT_NE(complaint_of_json("{\"a\": ").find("given.json"), std::string::npos);
  EXPECT_NE(complaint_of_json("[" + std::string(400, '9') + "]").find("given.json"),
            std::string::npos);
}

TEST(Json, ThatIsShownIsTheSameJson) {
  const Json json = {{"message", "\x1b[2J \u009b \x7f \u202e \n \" \\ θ"}};
  const std::string shown = printable(json_text(json));
  EXPECT_EQ(Json::parse(shown), json);
  EXPECT_EQ(shown.find('\x7f'), std::string::npos);
}

// Whatever a component says or a path is made of, JSON is written of it.
TEST(Json, IsWrittenOfTextThatIsNoUtf8) {
  EXPECT_EQ(json_text(Json{{"message", "x\xff"}}), "{\"message\":\"x\uFFFD\"}");
  EXPECT_EQ(json_text(Json(std::string("cut \xCE"))), "\"cut \uFFFD\"");
}

constexpr const char* kText = R"({"integer":-7,"large":18446744073709551615,
  "real":5.266142885157513e-10,"text":"½ \"quoted\"","truth":true,"nothing":null,"list":[0,1,2],
  "reals":[1.0,"inf","-inf","nan",3],"lists":{"b":[1],"a":[]},"words":["x","y"]})";

TEST(JsonView, ReadsEachTypeAsItStands) {
  JsonReader reader;
  const JsonView json = reader.parse(kText, "it");
  EXPECT_EQ(json.json(), Json::parse(kText));
  EXPECT_EQ(json.at("integer").get<std::int64_t>(), -7);
  EXPECT_EQ(json.at("text").get<std::string>(), "½ \"quoted\"");
  EXPECT_TRUE(json.at("truth").get<bool>());
  EXPECT_TRUE(json.at("nothing").is_null());
  EXPECT_TRUE(json.contains("list"));
  EXPECT_FALSE(json.contains("absent"));
  EXPECT_EQ(json.at("list").get<std::vector<std::int64_t>>(), (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(json.at("words").get<std::vector<std::string>>(), (std::vector<std::string>{"x", "y"}));
  const auto lists = json.at("lists").items();
  ASSERT_EQ(lists.size(), 2U);
  EXPECT_EQ(lists[0].first, "b");
  EXPECT_EQ(lists[0].second.get<std::vector<std::int64_t>>(), std::vector<std::int64_t>{1});
  EXPECT_TRUE(lists[1].second.values().empty());
}

TEST(JsonView, RealsKeepEveryBitAndWhatIsNotFinite) {
  JsonReader reader;
  const JsonView json = reader.parse(kText, "it");
  EXPECT_EQ(real_of(json.at("real")), 5.266142885157513e-10);
  const std::vector<Real> reals = reals_of(json.at("reals"));
  ASSERT_EQ(reals.size(), 5U);
  EXPECT_EQ(reals[1], INFINITY);
  EXPECT_EQ(reals[2], -INFINITY);
  EXPECT_TRUE(std::isnan(reals[3]));
  EXPECT_EQ(reals[4], 3);
}

TEST(JsonView, SaysWhatItLacksAndWhatItFoundInstead) {
  JsonReader reader;
  const JsonView json = reader.parse(kText, "it");
  EXPECT_NE(refusal([&] { json.at("absent"); }).find("absent"), std::string::npos);
  EXPECT_NE(refusal([&] { json.at("text").get<std::int64_t>(); }).find("integer"),
            std::string::npos);
  EXPECT_NE(refusal([&] { real_of(json.at("text")); }).find("number"), std::string::npos);
  EXPECT_NE(refusal([&] { reals_of(json.at("words")); }).find("number"), std::string::npos);
  EXPECT_NE(refusal([&] { json.at("large").get<std::int64_t>(); }).find("integer"),
            std::string::npos);
  const std::string cut = std::string(kText).substr(0, 60);
  EXPECT_NE(refusal([&] { reader.parse(cut, "runs/a.json"); }).find("runs/a.json"),
            std::string::npos);
  EXPECT_EQ(refusal([&] { reader.parse(kText, "it"); }), "") << "the reader is good for the next";
}

// Each law on an element that one of the column breaks is broken by the outline.
TEST(Outline, KeepsOfALongColumnWhatLawsOnItsElementsAskFor) {
  Json document{{"short", {1, 2, 3}}, {"mixed", Json::array()}, {"rows", Json::array()}};
  Json column = Json::array();
  for (int i = 0; i < 100; ++i) column.push_back(i);
  document["counts"] = column;
  column[50] = -7;
  document["negative"] = column;
  column[50] = "nan";
  column[51] = 0.5;
  column[52] = std::uint64_t{1} << 63;
  document["mixed"] = column;
  column[53] = nullptr;
  document["rows"] = column;
  const Json outline = outline_of(json_text(document), "given");
  EXPECT_EQ(outline["short"], document["short"]);
  EXPECT_EQ(outline["counts"], (Json{0, 99}));
  EXPECT_EQ(outline["negative"], (Json{-7, 99}));
  EXPECT_EQ(outline["mixed"],
            (Json{0.5, 0.5, 0, 99, std::uint64_t{1} << 63, std::uint64_t{1} << 63, "nan"}));
  EXPECT_EQ(outline["rows"], document["rows"]) << "null is neither number nor text";
}

// `validate` looks at outlines of records.
TEST(Outline, LosesNothingThatTheSchemaOfRecordsAsksFor) {
  const std::string schema = json_text(run_schema());
  for (const char* law : {"minItems", "maxItems", "uniqueItems", "contains", "multipleOf"})
    EXPECT_EQ(schema.find(law), std::string::npos) << law;
}

TEST(Outline, OfWhatIsNoJsonIsAUsageErrorThatNamesItsOrigin) {
  for (const std::string& text : {std::string("{"), std::string("[1e400]"), std::string(2000, '[')})
    EXPECT_NE(refusal([&] { outline_of(text, "given.json"); }).find("given.json"),
              std::string::npos);
}

}  // namespace
}  // namespace isoline
