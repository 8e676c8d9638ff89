// Results in the forms of others: CSV that reads back. tests/exchange/coco_test.py holds what
// COCO's folders must be: it reads them by the format's rules.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/json.h"
#include "core/records/json_view.h"
#include "reports/formats/formats.h"
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

TEST(Coco, LeavesOutAndNamesWhatItCannotSay) {
  const Study study = study_of({{"square", "gd", 2}});
  const Export coco = coco_export(compare_optimizers(study));
  ASSERT_EQ(coco.left_out.size(), 1U);
  EXPECT_NE(coco.left_out[0].find("square"), std::string::npos);
  EXPECT_EQ(coco.files.size(), 1U) << "the list of functions alone";
}

TEST(Coco, FoldersOfMethodsAreToldApart) {
  Study study = study_of({{"square", "gd[rate=1]", 2}, {"square", "gd(rate=1)", 2}});
  study.sheets.push_back(
      {.kind = "problem", .name = "square", .spec = "square", .options_text = "[]", .unknowns = 1});
  const Export coco = coco_export(compare_optimizers(study));
  EXPECT_TRUE(coco.files.contains("gd-rate-1/isoline_f1.info"));
  EXPECT_TRUE(coco.files.contains("gd-rate-1-2/isoline_f1.info"));
}

}  // namespace
}  // namespace isoline::reports
