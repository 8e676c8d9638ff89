// Rows of one method at its defaults and at the rates of tables.
#include <gtest/gtest.h>

#include <algorithm>

#include "reports/report.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

Record run_of(const char* problem, const char* spec, const char* rates, int per_hit = 2) {
  Record record = record_of({.problem = problem, .optimizer = spec, .work_per_hit = per_hit});
  record.request.rates = rates;
  return record;
}

std::vector<std::string> labels_of(const Comparison& c) {
  std::vector<std::string> labels;
  for (const OptimizerAxis& axis : c.optimizers) labels.push_back(axis.label);
  std::ranges::sort(labels);
  return labels;
}

// Another rate on every problem makes no rows of its own.
TEST(Labels, TunedRatesAndDefaultsOfOneMethodAreTwoRows) {
  Study study;
  study.runs = {run_of("p", "gd", ""), run_of("p", "gd[rate=0.1]", "direct.json", 1),
                run_of("q", "gd", ""), run_of("q", "gd[rate=0.2]", "direct.json", 1)};
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(labels_of(c), (std::vector<std::string>{"gd", "gd, tuned"}));
  const Table table = tuned_and_defaults_table(c);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0][0].text, "gd");
  EXPECT_EQ(table.rows[0][4].text, "2 : 0");
  EXPECT_EQ(table.rows[0][5].text, "0.5");
}

// On q the best value is the default: one run, which both rows have, and which is counted once.
TEST(Labels, WhereTheTunedRateIsTheDefaultTheRunStandsInBothRows) {
  Study study;
  study.runs = {run_of("p", "gd", ""), run_of("p", "gd[rate=0.1]", "direct.json"),
                run_of("q", "gd", "direct.json")};
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(labels_of(c), (std::vector<std::string>{"gd", "gd, tuned"}));
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t p = 0; p < 2; ++p) EXPECT_EQ(c.cell(p, s).runs.size(), 1U) << p << s;
  EXPECT_EQ(c.statuses.at(Status::target), 3U);
  EXPECT_NE(document_of(c).headline.find("3 runs"), std::string::npos) << document_of(c).headline;
  const std::string csv = csv_report(document_of(c));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 4) << "the header and a line a run";
}

// A sweep is no tuning, though a table is there for options that it leaves open: each setting is a
// row, and no two share one.
TEST(Labels, SettingsOfASweepAreRowsOfTheirOwn) {
  Study study;
  study.runs = {run_of("p", "hig", "learn.json"), run_of("p", "hig[rate=3]", "learn.json"),
                run_of("p", "hig[rate=9]", "learn.json"), run_of("q", "hig[rate=3]", "learn.json")};
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(labels_of(c), (std::vector<std::string>{"hig", "hig[rate=3]", "hig[rate=9]"}));
  for (std::size_t s = 0; s < 3; ++s) EXPECT_EQ(c.cell(0, s).runs.size(), 1U) << s;
}

TEST(Labels, TellValueAndOriginWhereATableChose) {
  Study study;
  study.runs = {run_of("p", "gd[rate=3.8e-05]", "direct.json"),
                run_of("q", "gd[rate=1]", "learn.json"), run_of("p", "ceres-lm", "")};
  study.rates = rates_from_text(
      R"({"rows": [
        {"problem": "p", "optimizer": "gd", "options": {"rate": 3.8e-5}, "file": "direct.json",
         "source": {"grid": {"rate": [3.8e-5, 1]}, "score": [[60, 1], ["inf", 2]], "edge": true}},
        {"problem": "q", "optimizer": "gd", "options": {"rate": 1}, "file": "learn.json",
         "source": {"paper": "Fig. 2"}}]})",
      "rates.json");
  const Comparison c = compare_optimizers(study);
  const auto at = [&](const std::string& label) {
    return static_cast<std::size_t>(std::ranges::find(c.optimizers, label, &OptimizerAxis::label) -
                                    c.optimizers.begin());
  };
  EXPECT_EQ(setting_text(c, 0, at("gd")), "gd (3.8e-5, tuned)");
  EXPECT_EQ(setting_text(c, 1, at("gd")), "gd (1, published)");
  EXPECT_EQ(setting_text(c, 0, at("ceres-lm")), "ceres-lm");
  const Section section = document_of(c).section("tuning");
  EXPECT_NE(section.readings[0].text.find("1 has rates tuned"), std::string::npos)
      << section.readings[0].text;
  EXPECT_NE(section.readings[1].text.find("at an edge of its grid for 1 of 1 tuned rate,"),
            std::string::npos)
      << section.readings[1].text;
  ASSERT_EQ(section.plots.size(), 1U);
  // One of two values gets there: half, and with both all.
  EXPECT_EQ(section.plots[0].series[0].y, (std::vector<Real>{0.5, 1}));
}

Record foreign_run(const char* problem, const std::string& spec, const std::string& name) {
  Record record = record_of({.problem = problem, .optimizer = spec});
  record.foreign.optimizer = Foreign{.door = "process", .command = "mine", .label = name};
  return record;
}

// What another program calls itself is its name, unless somebody has that already.
TEST(Labels, OfOtherProgramsAreTheirOwnNamesAndMarked) {
  const std::string first = "process[command=\"python3 a.py lm\"]", second = "process[command=b]";
  Study study;
  study.runs = {run_of("p", "gd", ""), foreign_run("p", first, "scipy-lm"),
                foreign_run("p", second, "gd")};
  study.runs[0].foreign.problem = Foreign{.door = "process", .command = "mine", .label = "spring"};
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(labels_of(c), (std::vector<std::string>{"gd", second, "scipy-lm"}));
  EXPECT_EQ(problem_name(c.problems[0]), "spring ‡");
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    EXPECT_EQ(optimizer_text(c, s).ends_with(" ‡"), c.optimizers[s].label != "gd");
  const Document document = document_of(c);
  const std::string page = html_report(document);
  EXPECT_NE(page.find("<b>‡</b>: computed by another program"), std::string::npos);
  for (const std::string& text : {page, markdown_report(document), terminal_table(document)})
    EXPECT_NE(text.find("scipy-lm ‡"), std::string::npos);
  for (const std::string& text : {markdown_report(document), terminal_table(document)})
    EXPECT_NE(text.find("‡: computed by another program."), std::string::npos);
}

TEST(Labels, WithoutOtherProgramsSayNothingOfThem) {
  Study study;
  study.runs = {run_of("p", "gd", ""), run_of("p", "adam", "")};
  EXPECT_EQ(terminal_table(document_of(compare_optimizers(study))).find("‡"), std::string::npos);
}

}  // namespace
}  // namespace isoline::reports
