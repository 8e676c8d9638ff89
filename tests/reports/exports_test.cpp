// Results in the forms of others: CSV that reads back, and metrics with all that failed. What
// COCO's folders must be is held by tests/exchange/coco_test.py, which reads them by the format's
// rules.
#include "reports/exports/exports.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/records/json_view.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// Rows of fields by RFC 4180, read the plain way.
std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows(1, {""});
  bool is_quoted = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    std::string& field = rows.back().back();
    if (is_quoted && csv.compare(i, 2, "\"\"") == 0) {
      field += csv[i++];
    } else if (csv[i] == '"') {
      is_quoted = !is_quoted;
    } else if (is_quoted || (csv[i] != ',' && csv[i] != '\r' && csv[i] != '\n')) {
      field += csv[i];
    } else if (csv[i] == ',') {
      rows.back().emplace_back();
    } else if (csv.compare(i, 2, "\r\n") == 0) {
      rows.push_back({""});
      ++i;
    } else {
      ADD_FAILURE() << "a line ends by itself at " << i;
    }
  }
  EXPECT_EQ(rows.back(), std::vector<std::string>{""}) << "the last line ends, too";
  rows.pop_back();
  return rows;
}

std::string at(const std::vector<std::vector<std::string>>& rows, std::size_t row,
               const std::string& column) {
  const auto place = std::ranges::find(rows[0], column) - rows[0].begin();
  return rows.at(row).at(static_cast<std::size_t>(place));
}

TEST(CurvesCsv, HasARowAPointOfEachRunAndEveryRowAllColumns) {
  const Study study = study_of({{"square", "gd", 2}, {"sine", "adam", 3}});
  const auto rows = rows_of(curves_csv(compare_optimizers(study)));
  EXPECT_EQ(rows.size(), 1U + 2 * 51);
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
}

TEST(CurvesCsv, ReadsBackToTheSameNumbersAndTexts) {
  Record record = record_of({.problem = "p[note=\"a, \"\"b\"\"\"]", .hits = 4});
  record.curve.loss = {0.1, 1.0 / 3, std::numeric_limits<Real>::infinity(), std::nan("")};
  record.verified["1e-6"] = true;
  Study study;
  study.runs = {record};
  const auto rows = rows_of(curves_csv(compare_optimizers(study)));
  EXPECT_EQ(at(rows, 1, "problem"), record.request.problem.spec);
  EXPECT_EQ(std::stod(at(rows, 1, "loss")), 0.1);
  EXPECT_EQ(std::stod(at(rows, 2, "loss")), 1.0 / 3);
  EXPECT_EQ(at(rows, 3, "loss"), "inf");
  EXPECT_EQ(at(rows, 4, "loss"), "nan");
  EXPECT_EQ(at(rows, 2, "work"), "2");
  EXPECT_EQ(at(rows, 2, "verified_1e-6"), "true");
  EXPECT_EQ(at(rows, 2, "verified_1e-3"), "") << "it is not known";
  EXPECT_EQ(at(rows, 2, "imported"), "false");
}

TEST(CurvesCsv, ARunWithoutACurveHasOneRow) {
  Study study;
  study.runs = {record_of({.hits = 0, .status = Status::failed})};
  const auto rows = rows_of(curves_csv(compare_optimizers(study)));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].size(), rows[0].size());
  EXPECT_EQ(at(rows, 1, "status"), "failed");
  EXPECT_EQ(at(rows, 1, "loss"), "");
}

// The schema that Bencher publishes of its format, in our words.
const Json kBencher = parse_json(R"({
  "type": "object",
  "additionalProperties": {
    "type": "object",
    "additionalProperties": {
      "type": "object", "required": ["value"], "additionalProperties": false,
      "properties": {"value": {"type": "number"}, "lower_value": {"type": "number"},
                     "upper_value": {"type": "number"}}}}})",
                                 "schema");

TEST(Bencher, IsInTheFormOfItsFormat) {
  const Study study = study_of({{"square", "gd", 2}, {"square", "adam", 0}, {"sine", "gd", 5}});
  const Json json = parse_json(bencher_json(compare_optimizers(study)), "export");
  EXPECT_EQ(schema_violations(json, kBencher), std::vector<std::string>{});
  EXPECT_EQ(json.size(), 3U);
  const Json& measures = json.at("square × gd");
  EXPECT_EQ(measures.at("work-to-1e-6").at("value"), 60) << "2 a rung, 30 rungs";
  EXPECT_EQ(measures.at("reached-1e-6").at("value"), 1);
}

TEST(Bencher, WhatWasNeverReachedIsLeftOutAndCounted) {
  const Study study = study_of({{"square", "adam", 0}});
  const Json json = parse_json(bencher_json(compare_optimizers(study)), "export");
  const Json& measures = json.at("square × adam");
  EXPECT_FALSE(measures.contains("work-to-1e-6"));
  EXPECT_EQ(measures.at("reached-1e-6").at("value"), 0);
  EXPECT_TRUE(measures.contains("work-to-1e-1"));
}

TEST(Bencher, IntervalsAreThoseOfTheSeeds) {
  Study study;
  for (const std::uint64_t seed : {0, 1, 2})
    study.runs.push_back(
        record_of({.seed = seed, .work_per_hit = static_cast<std::int64_t>(seed) + 1}));
  const Json json = parse_json(bencher_json(compare_optimizers(study)), "export");
  const Json& work = json.at("square × gd").at("work-to-1e-6");
  EXPECT_EQ(work.at("lower_value"), 30);
  EXPECT_EQ(work.at("value"), 60);
  EXPECT_EQ(work.at("upper_value"), 90);
}

TEST(Coco, LeavesOutAndNamesWhatItCannotSay) {
  const Study study = study_of({{"square", "gd", 2}});
  const CocoExport coco = coco_export(compare_optimizers(study));
  ASSERT_EQ(coco.left_out.size(), 1U);
  EXPECT_NE(coco.left_out[0].find("square"), std::string::npos);
  EXPECT_EQ(coco.files.size(), 1U) << "the list of functions alone";
}

TEST(Coco, FoldersOfMethodsAreToldApart) {
  Study study = study_of({{"square", "gd[rate=1]", 2}, {"square", "gd(rate=1)", 2}});
  study.sheets.push_back(
      {.kind = "problem", .name = "square", .spec = "square", .options_text = "[]", .unknowns = 1});
  const CocoExport coco = coco_export(compare_optimizers(study));
  std::set<std::string> names;
  for (const ExportedFile& file : coco.files) EXPECT_TRUE(names.insert(file.name).second);
  EXPECT_TRUE(names.contains("gd-rate-1/isoline_f1.info"));
  EXPECT_TRUE(names.contains("gd-rate-1-2/isoline_f1.info"));
}

}  // namespace
}  // namespace isoline::reports
