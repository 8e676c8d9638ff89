// Fields in the page: colours that are even, bytes that say what cells hold, the best of each kind.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/files.h"
#include "core/json.h"
#include "reports/page/bitmap.h"
#include "reports/page/fields_html.h"
#include "reports/read/found_fields.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// --- pictures

TEST(Radix64, IsThatOfTheStandard) {  // the test vectors of RFC 4648, section 10
  EXPECT_EQ(radix64(""), "");
  EXPECT_EQ(radix64("f"), "Zg==");
  EXPECT_EQ(radix64("fo"), "Zm8=");
  EXPECT_EQ(radix64("foo"), "Zm9v");
  EXPECT_EQ(radix64("foob"), "Zm9vYg==");
  EXPECT_EQ(radix64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(radix64("foobar"), "Zm9vYmFy");
}

Real lightness(const Colour& colour) {  // L* of CIE Lab, from the luminance of sRGB
  Real luminance = 0;
  const Real weights[] = {0.2126, 0.7152, 0.0722};
  for (std::size_t i = 0; i < 3; ++i) {
    const Real share = colour[i] / 255.0;
    luminance +=
        weights[i] * (share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4));
  }
  return 116 * std::cbrt(luminance) - 16;
}

TEST(DivergingColours, DarkenEvenlyAndAlikeToBothSides) {
  constexpr int kSteps = 16;
  const Real light = lightness(diverging_colour(0)), dark = lightness(diverging_colour(1));
  EXPECT_GT(light, 95);
  EXPECT_LT(dark, 45);
  for (int i = 1; i <= kSteps; ++i) {
    const Real t = static_cast<Real>(i) / kSteps;
    const Real even = light + (dark - light) * t;
    for (const Real share : {-t, t})  // Oklab's lightness and CIE's bend a little otherwise
      EXPECT_NEAR(lightness(diverging_colour(share)), even, 3.5) << share;
  }
}

TEST(DivergingColours, EndAtTheScale) {
  EXPECT_EQ(diverging_colour(1.7), diverging_colour(1));
  EXPECT_EQ(diverging_colour(-9), diverging_colour(-1));
  EXPECT_LT(diverging_colour(1)[2], diverging_colour(-1)[2]) << "orange above, blue below";
}

TEST(Cells, AreBytesAroundZeroUpToTwiceTheScale) {
  const std::vector<float> values = {0, 1, -1, 2, -2, 9, -9, 0.5F};
  const std::string bytes = bytes_of(values, 1);
  std::vector<int> found;
  for (const char byte : bytes) found.push_back(static_cast<unsigned char>(byte));
  EXPECT_EQ(found, (std::vector<int>{128, 192, 64, 255, 1, 255, 1, 160}));
  EXPECT_EQ(bytes_of({}, 1), "");
  EXPECT_EQ(static_cast<unsigned char>(bytes_of(values, 0)[1]), 128) << "all is zero";
}

TEST(Bitmap, HasAHeadOfWholeDigitsAndRowsOfFourBytes) {
  const std::string head = bitmap_head(3, 5);
  EXPECT_EQ(head.size() % 4, 0U);
  EXPECT_EQ(head.find('='), std::string::npos);
  EXPECT_TRUE(head.starts_with("Qk")) << "BM";
  EXPECT_EQ(bitmap_cells(std::string(15, '\x80'), 5).size(), 32U) << "3 rows of 8 bytes";
}

// --- what is shown

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
    Record record = record_of(
        {.problem = "grid", .optimizer = optimizer, .seed = seed, .work_per_hit = per_hit});
    FieldFrames fields{.iterations = {0, 50}, .shape = {4, 1, 2}};
    fields.numbers = {4, 4, 1, 2, 0, 0, end, 2 * end};
    fields.digest = digest(field_file(fields));
    record.fields = fields;
    folder.add(record);
    write_text(field_path(folder.path() / "runs" / record.file_name()), field_file(fields));
    folder.add(sheet_of("optimizer", optimizer, kind));
    records.push_back(record);
  }
  std::optional<FoundFields> found() {
    Sheet sheet = sheet_of("problem", "grid");
    sheet.field = Field{.rows = 1, .columns = 2, .x = {"source", "1/m²"}, .y = {"potential"}};
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
  Record record = record_of({.problem = "grid", .optimizer = "fast", .work_per_hit = 2});
  FieldFrames fields{.iterations = {0}, .shape = {3, 1, 2}};
  fields.numbers = {4, 4, 1, 2, 0, 0};
  fields.digest = digest(field_file(fields));
  record.fields = fields;
  folder.add(record);
  write_text(field_path(folder.path() / "runs" / record.file_name()), field_file(fields));
  folder.add(sheet_of("optimizer", "fast", "gradient"));
  records.push_back(record);
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
                            "alt=\"x of fast: source, 1/m², from 0.9 to 1.8\""})
    EXPECT_NE(html.find(words), std::string::npos) << words << " in " << html;
  std::size_t pictures = 0, alts = 0;
  for (std::size_t at = 0; (at = html.find("<img ", at)) != std::string::npos; ++at) ++pictures;
  for (std::size_t at = 0; (at = html.find("alt=\"", at)) != std::string::npos; ++at) ++alts;
  EXPECT_EQ(pictures, 5U) << "y*, x*, x, x − x* and the colours";
  EXPECT_EQ(alts, pictures);
}

TEST_F(ShownFields, AreTheSameBytesInTheDataAndInThePictures) {
  add("fast", "gradient", 2, 0.9F);
  const auto all = found();
  ASSERT_TRUE(all);
  const Json json = parse_json(fields_json(*all), "fields");
  const auto& one = json.at("found").at(0);
  EXPECT_EQ(one.at("iterations"), Json({0, 50}));
  EXPECT_EQ(one.at("apart"), Json({"= 1", "= 0.1"}));
  const std::string head = json.at("head"), last = one.at("x").at(1);
  EXPECT_NE(fields_html(c, *all).find(head + last), std::string::npos);
}

}  // namespace
}  // namespace isoline::reports
