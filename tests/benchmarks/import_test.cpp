// A curve of others becomes a record that is marked as theirs; one that is damaged is told of in
// one sentence with its line.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/import/imported_record.h"
#include "benchmarks/merge/contradictions.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/records/plan.h"
#include "core/records/schema.h"
#include "reports/read/comparison.h"
#include "tests/benchmarks/builtin_schema.h"
#include "tests/reports/fixture.h"

namespace isoline::benchmarks {
namespace {

using reports::ResultFolder;

const Catalog& catalog() {
  static const Catalog all = builtin_catalog();
  return all;
}

Json description(const Json& columns = {{"loss", "f"}, {"forward", "nfev"}}) {
  return {{"schema", "isoline.import/1"},
          {"problem", "rosenbrock"},
          {"optimizer", "their-lm"},
          {"seed", 0},
          {"source", "Table 2"},
          {"date", "2026-01-31"},
          {"columns", columns}};
}

Record imported(const std::string& csv, const Json& told = description()) {
  const ForeignFiles files{csv, json_text(told), "theirs.csv"};
  const CurveDescription read = description_from_text(files.description, "theirs.json");
  return imported_record(catalog(), read, curve_from_text(csv, "theirs.csv", read), files);
}

std::string refusal(const std::string& csv, const Json& told = description()) {
  try {
    imported(csv, told);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

const std::string kCurve = "iter,f,nfev\n0,24.2,1\n1,4,3\n2,1e-6,5\n3,0,7\n";

TEST(Import, MakesARecordThatConformsAndIsMarked) {
  const Record record = imported(kCurve);
  const Json json = to_json(record);
  EXPECT_EQ(schema_violations(json, schema("run")), std::vector<std::string>{});
  EXPECT_EQ(cell_violation(json), "");
  ASSERT_TRUE(record.imported);
  EXPECT_EQ(record.imported->source, "Table 2");
  for (const auto& [tau, verified] : record.verified) EXPECT_EQ(verified, std::nullopt) << tau;
  EXPECT_EQ(record.verified.size(), kVerified.size());
  EXPECT_EQ(file_text(record_from_text(file_text(record), "again")), file_text(record));
}

TEST(Import, OfTheSameFilesIsTheSameRecordAndOfOthersAnother) {
  EXPECT_EQ(file_text(imported(kCurve)), file_text(imported(kCurve)));
  EXPECT_NE(imported(kCurve).build, imported(kCurve + "4,0,9\n").build);
  EXPECT_EQ(imported(kCurve).cell, imported(kCurve + "\n").cell);
}

// Of rosenbrock f_L = 0 and s = 12.1, half of its f₀: as records of ours have it.
TEST(Import, OfAProblemOfOursIsMeasuredByItsTargets) {
  const Record record = imported(kCurve);
  EXPECT_EQ(record.minimum, 0);
  ASSERT_TRUE(record.hits);
  ASSERT_TRUE(record.scale);
  EXPECT_NEAR(*record.scale, 12.1, 1e-9);
  EXPECT_EQ(record.hits->work[0], 3) << "24.2 is more than s";
  EXPECT_EQ(record.hits->work[5], 5) << "4 is more than a tenth of s";
  EXPECT_EQ(record.hits->iteration[50], 3);
  EXPECT_NE(refusal(kCurve,
                    [] {
                      Json told = description();
                      told["minimum"] = -1;
                      return told;
                    }()),
            "");
}

TEST(Import, OfAProblemOfOthersIsMeasuredByWhatTheyTell) {
  Json told = description();
  told["problem"] = "their-bridge[span=30]";
  EXPECT_FALSE(imported(kCurve, told).hits) << "no least loss is known";
  told["minimum"] = 0;
  told["scale"] = 1;
  const Record record = imported(kCurve, told);
  EXPECT_EQ(record.scale, 1);
  EXPECT_EQ(record.hits->work[0], 5);
  EXPECT_EQ(record.request.problem.spec, "their-bridge[span=30]");
}

TEST(Import, TakesFilesAsTheyComeFromOtherSystems) {
  const Record plain = imported(kCurve);
  std::string others = "\xEF\xBB\xBF";
  for (const char letter : kCurve)
    others += letter == '\n' ? std::string("\r\n") : std::string(1, letter);
  EXPECT_EQ(imported(others).curve.loss, plain.curve.loss);
  EXPECT_EQ(
      imported("\"iter\", \"f\" ,\"nfev\"\n0, 24.2 ,1\n1,+4,3\n2,\"1e-6\",5\n3,0,7").curve.loss,
      plain.curve.loss);
  EXPECT_EQ(
      imported("0,24.2,1\n1,4,3\n2,1e-6,5\n3,0,7\n", description({{"loss", 2}, {"forward", 3}}))
          .curve.loss,
      plain.curve.loss);
}

TEST(Import, KeepsWhatIsNotFinite) {
  const Record record = imported("f,nfev\n3,1\nNaN,2\ninf,3\n-Infinity,4\nnan,5\n");
  EXPECT_TRUE(std::isnan(record.curve.loss[1]));
  EXPECT_TRUE(std::isinf(record.curve.loss[2]));
  EXPECT_EQ(record.status, Status::diverged);
}

TEST(Import, ThinsAMillionRowsAndMissesNoTarget) {
  std::string csv = "f,nfev\n";
  for (int row = 0; row < 1'000'000; ++row)
    csv += (row < 654'321 ? "1," : "0,") + std::to_string(row) + "\n";
  const Record record = imported(csv);
  EXPECT_LT(record.curve.loss.size(), 300U);
  EXPECT_EQ(record.curve.iteration.back(), 999'999);
  EXPECT_EQ(record.hits->iteration[50], 654'321);
}

struct Damage {
  std::string csv, sentence;
};

TEST(Import, OfADamagedFileIsOneSentenceWithItsLine) {
  const std::vector<Damage> all = {
      {"", "it is empty"},
      {"\n\n", "it is empty"},
      {"f,nfev\n", "it holds no row"},
      {"f,nfev\n1,2\n3\n", "line 3: it has 1 fields, and the first line has 2"},
      {"f,nfev\n1,2\n3,4,5\n", "line 3: it has 3 fields"},
      {"f,nfev\n1,2\n\n\nx,4\n", "line 5: loss is no number: 'x'"},
      {"f,nfev\n1,2\n,4\n", "line 3: loss is missing"},
      {"f,nfev\n1,2.5\n", "line 2: forward must be a whole number from 0, got '2.5'"},
      {"f,nfev\n1,-2\n", "line 2: forward must be"},
      {"f,nfev\n1,\n", "line 2: forward must be"},
      {"f,nfev\n1,1e300\n", "line 2: forward must be"},
      {"f,nfev\n1,4\n1,3\n", "line 3: forward falls from 4 to 3"},
      {"g,nfev\n1,4\n", "line 1: no column is named 'f': there are g, nfev"},
      {"f,f,nfev\n1,1,4\n", "line 1: two columns are named 'f'"},
      {"1,4\n1,5\n", "line 1: there is no line of names to find"},
      {"f,nfev\n\"1,4\n", "line 2: it opens quotes that are not closed"},
      {"f,nfev\n1\"2,4\n", "line 2: quotes stand in the middle"},
      {"f,nfev\n\"1\"x,4\n", "line 2: a text goes on after its quotes"},
      {std::string("f,nfev\n1,\0004\n", 12), "line 2: it holds a zero byte"}};
  for (const auto& [csv, sentence] : all) {
    const std::string told = refusal(csv);
    EXPECT_NE(told.find(sentence), std::string::npos) << csv << "\n" << told;
    EXPECT_TRUE(told.starts_with("theirs.csv")) << told;
    EXPECT_EQ(told.find('\n'), std::string::npos) << told;
    EXPECT_LT(told.size(), 300U) << told;
  }
}

TEST(Import, OfALongFieldTellsItsBeginning) {
  EXPECT_LT(refusal("f,nfev\n" + std::string(1'000'000, 'x') + ",4\n").size(), 300U);
}

TEST(Import, IterationsRiseByTheirOwnColumn) {
  const Json told = description({{"loss", "f"}, {"forward", "n"}, {"iteration", "i"}});
  EXPECT_NE(refusal("i,f,n\n0,1,1\n0,1,2\n", told).find("line 3: iteration 0 stands there twice"),
            std::string::npos);
  EXPECT_NE(refusal("i,f,n\n5,1,1\n4,1,2\n", told).find("line 3: iteration falls"),
            std::string::npos);
}

TEST(Import, ADescriptionKeepsItsLaws) {
  const auto refused = [](const char* member, const Json& value) {
    Json told = description();
    told[member] = value;
    return refusal(kCurve, told);
  };
  EXPECT_NE(refused("optimizer", "adam").find("adam is an optimizer of ours"), std::string::npos);
  EXPECT_NE(refused("date", "31 January").find("date must be"), std::string::npos);
  EXPECT_NE(refused("date", "2026-02-31").find("date must be"), std::string::npos);
  EXPECT_NE(refused("problem", "sine[xi=-3]").find("xi must be"), std::string::npos);
  EXPECT_NE(refused("columns", {{"loss", "f"}}).find("what the curve cost"), std::string::npos);
  EXPECT_NE(
      refused("columns", {{"loss", "f"}, {"jacobian", "nfev"}}).find("depends on the problem"),
      std::string::npos);
  EXPECT_NE(refused("columns", {{"loss", "f"}, {"work", 9}}).find("should stand in column 9"),
            std::string::npos);
  const Json broken = {{"seed", -1},
                       {"source", ""},
                       {"colour", "red"},
                       {"status", "solved"},
                       {"schema", "isoline.import/2"},
                       {"columns", {{"loss", "f"}, {"work", 0}}}};
  for (const auto& [member, value] : broken.items())
    EXPECT_NE(refused(member.c_str(), value).find("is no description of a curve"),
              std::string::npos)
        << member;
}

// --- in the tables

TEST(Import, StandsInTheTablesMarkedAndMovesNobodysTargets) {
  Json told = description();
  told["problem"] = "square";
  const Record theirs = imported("f,nfev\n1,1\n-5,2\n", told);
  reports::Study study;
  study.runs = {reports::record_of({.problem = "square", .optimizer = "gd"}), theirs};
  study.runs[0].minimum.reset();
  study.runs[1].minimum.reset();
  const reports::Comparison comparison = compare_optimizers(study);
  ASSERT_EQ(comparison.optimizers.size(), 2U);
  for (const reports::OptimizerAxis& axis : comparison.optimizers)
    EXPECT_EQ(axis.is_imported, axis.method == "their-lm");
  EXPECT_GT(comparison.runs[0].minimum, -5) << "what others say is no least loss of ours";
}

}  // namespace
}  // namespace isoline::benchmarks
