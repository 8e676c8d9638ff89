// Fields in the page: the best of each kind, what is said of them, histories, their bytes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "reports/page/page.h"
#include "reports/sections/figures.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

Sheet sheet_of(const char* kind, const std::string& name, const std::string& mathematics = "") {
  Sheet sheet{.kind = kind, .name = name, .spec = name, .options_text = "[]"};
  sheet.mathematics = mathematics;
  sheet.inverse = "none";
  return sheet;
}

class ShownFields : public testing::Test {
 protected:
  // x* is (1, 2), y* (4, 4), and a run goes from x = 0 to `end` times x*.
  void add(const char* optimizer, const char* kind, std::int64_t per_hit, float end,
           std::uint64_t seed = 0) {
    add_frames(
        optimizer, kind, per_hit,
        {.iterations = {0, 50}, .shape = {4, 1, 2}, .numbers = {4, 4, 1, 2, 0, 0, end, 2 * end}},
        seed);
  }
  void add_frames(const char* optimizer, const char* kind, std::int64_t per_hit, FieldFrames fields,
                  std::uint64_t seed = 0) {
    Record record = record_of(
        {.problem = "grid", .optimizer = optimizer, .seed = seed, .work_per_hit = per_hit});
    fields.digest = digest(field_file(fields));
    record.fields = fields;
    folder.add(record);
    write_text(field_path(folder.path() / "runs" / record.file_name()), field_file(fields));
    folder.add(sheet_of("optimizer", optimizer, kind));
    records.push_back(record);
  }
  std::optional<FoundFields> found(
      const Field& field = {.rows = 1, .columns = 2, .x = {"source", "1/m²"}, .y = {"potential"}}) {
    Sheet sheet = sheet_of("problem", "grid");
    sheet.field = field;
    folder.add(sheet);
    folder.add(plan_of(records));
    study = read_study({folder.path()});
    c = compare_optimizers(study);
    return found_fields(c, 0);
  }
  std::string name(const FoundField& one) const { return c.optimizers[one.optimizer].label; }

  ResultFolder folder;
  std::vector<Record> records;
  Study study;
  Comparison c;
};

TEST_F(ShownFields, AreOfTheBestOfEachKind) {
  add("slow", "gradient", 9, 0.5F);
  add("fast", "gradient", 2, 0.9F);
  add("newton", "second-order", 1, 1.0F);
  const auto all = found();
  ASSERT_TRUE(all);
  ASSERT_EQ(all->found.size(), 2U);
  EXPECT_EQ(name(all->found[0]), "newton");
  EXPECT_EQ(name(all->found[1]), "fast");
  EXPECT_EQ(all->x_scale, 2);
  EXPECT_EQ(all->y_scale, 4);
  EXPECT_EQ(all->x.unit, "1/m²");
  EXPECT_NEAR(all->found[1].apart[0], 1, 1e-7);  // ‖0 − x*‖ / ‖x*‖
  EXPECT_NEAR(all->found[1].apart[1], 0.1, 1e-6);
}

TEST_F(ShownFields, OfRunsThatKeptFewerStepsStandBesideTheOthers) {
  add("newton", "second-order", 1, 1.0F);
  add_frames("fast", "gradient", 2,
             {.iterations = {0}, .shape = {3, 1, 2}, .numbers = {4, 4, 1, 2, 0, 0}});
  const auto all = found();
  ASSERT_TRUE(all);
  EXPECT_EQ(all->found.size(), 2U);
  EXPECT_NE(fields_html(c, *all).find("&lt; 1e-7"), std::string::npos) << "of newton";
}

TEST_F(ShownFields, AreAllOfOneSeed) {
  add("newton", "second-order", 1, 1.0F, 3);
  add("fast", "gradient", 2, 0.9F, 0);
  const auto all = found();
  ASSERT_TRUE(all);
  EXPECT_EQ(all->seed, 3U);
  EXPECT_EQ(all->found.size(), 1U) << "that of seed 0 has another x*";
}

TEST_F(ShownFields, ThatAreDamagedGiveWayToTheNextOfTheirKind) {
  add("slow", "gradient", 9, 0.5F);
  add("fast", "gradient", 2, 0.9F);
  write_text(field_path(folder.path() / "runs" / records[1].file_name()), "damaged");
  const auto all = found();
  ASSERT_TRUE(all);
  EXPECT_EQ(name(all->found[0]), "slow");
}

TEST_F(ShownFields, WithoutAnyAreNothing) {
  records.push_back(record_of({.problem = "grid", .optimizer = "gd"}));
  folder.add(records[0]);
  EXPECT_FALSE(found());
}

TEST_F(ShownFields, StandInTheArticleWithTheirUnitsScaleAndWhatIsMissing) {
  add("fast", "gradient", 2, 0.9F);
  const auto all = found();
  ASSERT_TRUE(all);
  const std::string html = fields_html(c, *all);
  for (const char* words : {"<h4>Fields</h4>", "source, 1/m²", "±4", "potential", "x − x*",
                            "<output class=at>50</output>", "<output class=apart>= 0.1</output>",
                            "aria-label=\"x of fast: source, 1/m², from 0.9 to 1.8\""})
    EXPECT_NE(html.find(words), std::string::npos) << words << " in " << html;
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = html.find("<canvas ", at)) != std::string::npos; ++at) ++pictures;
  EXPECT_EQ(pictures, 5U) << "y*, x*, x, x − x* and the colours";
}

TEST_F(ShownFields, AreTheSameBytesInTheDataAndInThePictures) {
  add("fast", "gradient", 2, 0.9F);
  const auto all = found();
  ASSERT_TRUE(all);
  const Json json = parse_json(fields_json(*all), "fields");
  const auto& one = json.at("found").at(0);
  EXPECT_EQ(one.at("iterations"), Json({0, 50}));
  EXPECT_EQ(one.at("apart"), Json({"= 1", "= 0.1"}));
  const std::string last = one.at("x").at(1);
  EXPECT_NE(fields_html(c, *all).find("data-cells=\"" + last + "\""), std::string::npos);
}

// --- histories

const Field kHistory{
    .rows = 2, .columns = 1, .x = {"speed before"}, .y = {"speed after"}, .time = 0.5};

class ShownHistory : public ShownFields {
 protected:
  // x* = 1 becomes y* = 4, and x = ½ of it 3; of y* the last row alone is known.
  void SetUp() override {
    add_frames("fast", "gradient", 2,
               {.iterations = {7}, .shape = {3, 2, 1}, .numbers = {0, 4, 1, 4, 0.5F, 3}});
  }
};

TEST_F(ShownHistory, IsJudgedByItsFirstRowAndHasOneScale) {
  const auto all = found(kHistory);
  ASSERT_TRUE(all);
  EXPECT_TRUE(all->is_history());
  EXPECT_EQ(all->found[0].apart, std::vector<Real>{0.5});
  EXPECT_EQ(all->x_scale, 4);
  EXPECT_EQ(all->y_scale, 4);
}

TEST_F(ShownHistory, IsDrawnFromTheBottomAndSaysSo) {
  const auto all = found(kHistory);
  ASSERT_TRUE(all);
  const std::string html = fields_html(c, *all);
  const std::string truth = radix64("\xC0\x90");  // y* = 4, above x* = 1
  for (const std::string& words :
       {truth, std::string("x* → y*"), std::string("x − x* → y − y*"),
        std::string("the lowest row is x, at 0, the highest y, at 0.5"),
        std::string("speed before → speed after"), std::string("the highest row alone")})
    EXPECT_NE(html.find(words), std::string::npos) << words << " in " << html;
  const Json json = parse_json(fields_json(*all), "fields");
  EXPECT_EQ(json.at("truth"), truth);
  EXPECT_EQ(json.at("labels"), Json({"x → y", "x − x* → y − y*"}));
}

TEST_F(ShownHistory, OfOlderRunsThatKeptXAloneIsNone) {
  Field other = kHistory;
  other.rows = 14;
  const auto all = found(other);
  ASSERT_TRUE(all);
  EXPECT_FALSE(all->is_history());
}

// --- bytes

TEST(Radix64, IsThatOfTheStandard) {  // the test vectors of RFC 4648, section 10
  for (const auto& [bytes, text] :
       {std::pair("", ""), {"fo", "Zm8="}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}})
    EXPECT_EQ(radix64(bytes), text);
}

TEST(Cells, AreBytesAroundZeroUpToTwiceTheScale) {
  const std::vector<float> values = {0, 1, -1, 2, -2, 9, -9, 0.5F};
  const std::string bytes = field_bytes(values, 1);
  std::vector<int> found;
  for (const char byte : bytes) found.push_back(static_cast<unsigned char>(byte));
  EXPECT_EQ(found, (std::vector<int>{128, 192, 64, 255, 1, 255, 1, 160}));
  EXPECT_EQ(field_bytes({}, 1), "");
  EXPECT_EQ(static_cast<unsigned char>(field_bytes(values, 0)[1]), 128) << "all is zero";
}

}  // namespace
}  // namespace isoline::reports
