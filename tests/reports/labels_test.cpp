// Rows of one method at its defaults and at the rates of tables.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/files.h"
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
  const Compared c({run_of("p", "gd", ""), run_of("p", "gd[rate=0.1]", "direct.json", 1),
                    run_of("q", "gd", ""), run_of("q", "gd[rate=0.2]", "direct.json", 1)});
  EXPECT_EQ(labels_of(c), (std::vector<std::string>{"gd", "gd, tuned"}));
  EXPECT_FALSE(has(terminal_table(document_of(c)), "‡")) << "no other program ran";
}

// On q the best value is the default: one run, which both rows have, and which is counted once.
TEST(Labels, WhereTheTunedRateIsTheDefaultTheRunStandsInBothRows) {
  const Compared c({run_of("p", "gd", ""), run_of("p", "gd[rate=0.1]", "direct.json"),
                    run_of("q", "gd", "direct.json")});
  EXPECT_EQ(labels_of(c), (std::vector<std::string>{"gd", "gd, tuned"}));
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t p = 0; p < 2; ++p) EXPECT_EQ(c.cell(p, s).runs.size(), 1U) << p << s;
  EXPECT_EQ(c.statuses.at(Status::target), 3U);
  EXPECT_TRUE(has(document_of(c).headline, "3 runs")) << document_of(c).headline;
  const std::string csv = csv_report(document_of(c));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 4) << "the header and a line a run";
}

// A sweep is no tuning, though a table is there for options that it leaves open: each setting is a
// row, and no two share one.
TEST(Labels, SettingsOfASweepAreRowsOfTheirOwn) {
  const Compared c({run_of("p", "hig", "learn.json"), run_of("p", "hig[rate=3]", "learn.json"),
                    run_of("p", "hig[rate=9]", "learn.json"),
                    run_of("q", "hig[rate=3]", "learn.json")});
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
  const auto place = [&](const std::string& label) {
    return static_cast<std::size_t>(std::ranges::find(c.optimizers, label, &OptimizerAxis::label) -
                                    c.optimizers.begin());
  };
  EXPECT_EQ(setting_text(c, 0, place("gd")), "gd (3.8e-5, tuned)");
  EXPECT_EQ(setting_text(c, 1, place("gd")), "gd (1, published)");
  EXPECT_EQ(setting_text(c, 0, place("ceres-lm")), "ceres-lm");
  const Section section = document_of(c).section("tuning");
  EXPECT_TRUE(has(section.readings[0].text, "1 has rates tuned")) << section.readings[0].text;
  EXPECT_TRUE(has(section.readings[1].text, "at an edge of its grid for 1 of 1 tuned rate,"))
      << section.readings[1].text;
  // One of two values gets there: half, and with both all.
  const Table& rates = section.tables.at(0);
  EXPECT_EQ(at(rates, "gd", "one value"), "0.50");
  EXPECT_EQ(at(rates, "gd", "of all"), "1.00");
}

// gd needs 80 with the value of the other families, adam does not get there at its default.
TEST(Labels, OfValuesChosenOnOtherFamiliesComeWithAComparisonOfThreeChoices) {
  Study study;
  study.runs = {run_of("p", "gd[rate=1]", "physics.json"), run_of("p", "adam", "physics.json")};
  std::string rows;
  for (const char* chosen : {R"("gd", "source": {"default": 0.1, "value": 1, )",
                             R"("adam", "source": {"default": 1, "value": 0.1, )"})
    rows += fmt::format(
        R"({}{{"problem": "p", "file": "physics.json", "optimizer": {}"spent": 900,
              "grid": {{"rate": [0.1, 1]}}, "mean_score": [0, 1], "families": ["q"]}}}},
           {{"problem": "p", "file": "physics-tuned.json", "optimizer": {}
              "grid": {{"rate": [0.1, 1]}}, "score": [[10, 1], [{}, 1]]}}}})",
        rows.empty() ? "" : ", ", chosen, chosen, rows.empty() ? "80" : "\"inf\"");
  study.rates = rates_from_text("{\"rows\": [" + rows + "]}", "rates.json");
  const Comparison c = compare_optimizers(study);
  const Table table = document_of(c).section("tuning").tables.at(1);
  EXPECT_EQ(at(table, "gd", "other families"), "0.50");
  EXPECT_EQ(at(table, "gd", "default"), "1.00");
  EXPECT_EQ(at(table, "adam", "other families"), "1.00");
  EXPECT_EQ(at(table, "adam", "default"), "0.00");
  EXPECT_EQ(at(table, "gd", "tuning work"), "900");
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
  EXPECT_TRUE(has(page, "<b>‡</b>: computed by another program"));
  for (const std::string& text : {page, markdown_report(document), terminal_table(document)})
    EXPECT_TRUE(has(text, "scipy-lm ‡"));
  for (const std::string& text : {markdown_report(document), terminal_table(document)})
    EXPECT_TRUE(has(text, "‡: computed by another program."));
}

TEST(ForeignText, StandsInEveryFormatWithoutControlSequences) {
  const ResultFolder folder;
  folder.add(record_of({}));
  folder.add(record_of({.optimizer = "adam[rate=\x1b[31m]",
                        .status = Status::failed,
                        .message = "\x1b[2J\u009b1m and \u202e back"}));
  write_report(document_of(compare_optimizers(read_study({folder.path()}))), folder.path() / "out");
  for (const std::string& name : names_in(folder.path() / "out")) {
    const std::string text = read_text(folder.path() / "out" / name);
    EXPECT_FALSE(has(text, "\x1b")) << name;
    if (name.ends_with(".html")) continue;
    EXPECT_FALSE(has(text, "\u009b")) << name;
    EXPECT_FALSE(has(text, "\u202e")) << name;
  }
}

}  // namespace
}  // namespace isoline::reports
