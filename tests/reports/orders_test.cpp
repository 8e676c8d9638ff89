// Which rows are compared: common settings, two meanings of one method, missing seeds, labels.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/files.h"
#include "core/oracle.h"
#include "core/results/advice.h"
#include "core/results/ranking.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// Three methods on four problems: a is ahead of b, b of c.
Study three_methods() {
  return study_of({{"p", "a", 1},
                   {"p", "b", 3},
                   {"p", "c", 9},
                   {"q", "a", 1},
                   {"q", "b", 3},
                   {"q", "c", 9},
                   {"r", "a", 1},
                   {"r", "b", 3},
                   {"r", "c", 9},
                   {"s", "a", 1},
                   {"s", "b", 3},
                   {"s", "c", 9}});
}

std::map<std::string, Real> scores_of(const Study& study) {
  const Comparison c = compare_optimizers(study);
  std::map<std::string, Real> scores;
  for (const OptimizerAxis& axis : c.optimizers) scores[axis.label] = axis.tightest().score;
  return scores;
}

TEST(Orders, MoreSettingsOfOneMethodMoveNoOther) {
  Study study = three_methods();
  const auto before = scores_of(study);
  for (const char* problem : {"t", "u", "v", "w", "x", "y"})
    study.runs.push_back(record_of({.problem = problem, .optimizer = "c", .work_per_hit = 1}));
  EXPECT_EQ(scores_of(study), before);
}

TEST(Orders, AMethodThatWasNotRunOnASharedSettingIsListedApart) {
  for (const std::size_t count : {1, 3}) {  // of the four
    Study study = three_methods();
    for (std::size_t i = 0; i < count; ++i)
      study.runs.push_back(record_of(
          {.problem = std::string(1, "pqr"[i]), .optimizer = "lucky", .work_per_hit = 1}));
    const Compared c(std::move(study));
    EXPECT_EQ(c.order.settings.size(), 4U);
    EXPECT_EQ(c.order.methods.size(), 3U);
    EXPECT_EQ(c.optimizers.back().label, "lucky");
    EXPECT_TRUE(has(joined(verdict(c)), "lucky on " + std::to_string(count)));
    EXPECT_EQ(c.optimizers[c.decision->places[0].method].label, "a");
  }
}

// It wins where it is given the inverse, and is last where it is not.
Study two_meanings() {
  Study study = three_methods();
  for (const auto& [problem, work] :
       {std::pair{"p", 0}, std::pair{"q", 0}, std::pair{"r", 20}, std::pair{"s", 20}}) {
    Record record = record_of({.problem = problem, .optimizer = "sip", .work_per_hit = work});
    if (work == 0) record.privileges = {std::string(name_of(Privilege::exact_inverse))};
    study.runs.push_back(std::move(record));
  }
  return study;
}

TEST(Orders, AMethodWithTwoMeaningsIsTwo) {
  const Compared c(two_meanings());
  ASSERT_EQ(c.order.methods.size(), 3U);
  ASSERT_EQ(c.optimizers.size(), 5U);
  const OptimizerAxis &plain = c.optimizers[3], &given = c.optimizers[4];
  EXPECT_EQ(given.label, "sip, given P⁻¹");
  EXPECT_EQ(plain.label, "sip");
  EXPECT_FALSE(given.privileges.empty());
  EXPECT_TRUE(plain.privileges.empty());
  const std::string unranked = unranked_sentence(c);
  EXPECT_TRUE(has(unranked, "sip (given P⁻¹) on 2 (1st of 4)")) << unranked;
  EXPECT_TRUE(has(unranked, "sip on 2 (4th of 4)")) << unranked;
}

TEST(Orders, AMethodThatSeesTheSameEverywhereStaysOne) {
  Study study = three_methods();
  for (Record& record : study.runs)
    if (record.request.optimizer.name == "a") record.privileges = {"exact Hessian"};
  study.runs[0].status = Status::inapplicable;  // and has seen nothing there
  study.runs[0].privileges.clear();
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(c.order.methods.size(), 3U);
}

// Of three seeds one is fast. Leaving the slow ones out must not make the method look better.
TEST(Orders, DroppingSeedsRaisesNoScore) {
  Study whole;
  for (const char* problem : {"p", "q", "r", "s"})
    for (const char* optimizer : {"a", "b", "c"})
      for (std::uint64_t seed = 0; seed < 3; ++seed)
        whole.runs.push_back(record_of({.problem = problem,
                                        .optimizer = optimizer,
                                        .seed = seed,
                                        .work_per_hit = seed == 0 ? 2 : 20}));
  const auto before = scores_of(whole);
  for (const bool is_planned : {true, false}) {
    Study part = whole;
    if (is_planned) part.plan = plan_of(whole.runs);
    std::erase_if(part.runs, [](const Record& record) {
      return record.request.optimizer.name == "a" && record.request.seed > 0;
    });
    EXPECT_LT(scores_of(part).at("a"), before.at("a")) << is_planned;
  }
}

TEST(Orders, AMissingSeedIsCounted) {
  Study study;
  study.runs = {record_of({.optimizer = "a"}), record_of({.optimizer = "a", .seed = 1}),
                record_of({.optimizer = "b"}), record_of({.optimizer = "b", .seed = 1})};
  study.plan = plan_of(study.runs);
  study.runs.pop_back();
  const Comparison c = compare_optimizers(study);
  const auto b = std::ranges::find(c.optimizers, "b", &OptimizerAxis::label) - c.optimizers.begin();
  const Cell& cell = c.cell(0, static_cast<std::size_t>(b));
  EXPECT_EQ(cell.headline[kTightest].n, 2U);
  EXPECT_EQ(cell.headline[kTightest].unsolved, 1U);
  EXPECT_FALSE(cell.headline[kTightest].is_solved());
}

// Twelve problems: `first` is four times as cheap as `second`, `kin` is like `first` by chance,
// `none` applies to none of them.
Study family() {
  Study study;
  for (int i = 0; i < 12; ++i) {
    const std::string problem(1, static_cast<char>('a' + i));
    const std::int64_t work = 10 + 3 * i;
    study.runs.push_back(
        record_of({.problem = problem, .optimizer = "first", .work_per_hit = work}));
    study.runs.push_back(
        record_of({.problem = problem, .optimizer = "second", .work_per_hit = 4 * work}));
    study.runs.push_back(record_of({.problem = problem,
                                    .optimizer = "kin",
                                    .work_per_hit = i % 2 == 0 ? 2 * work : work / 2 + 2}));
    study.runs.push_back(record_of({.problem = problem,
                                    .optimizer = "none",
                                    .hits = 0,
                                    .status = Status::inapplicable,
                                    .message = "no"}));
  }
  return study;
}

TEST(Orders, WhatAppliesNowhereIsNotRanked) {
  const Compared c(family());
  EXPECT_EQ(c.order.methods.size(), 3U);
  ASSERT_EQ(c.decision->places.size(), 3U);
  EXPECT_EQ(leader_table(c).rows.size(), 3U);
  EXPECT_TRUE(has(limits_of_evidence(c).front(), "Friedman")) << limits_of_evidence(c).front();
  EXPECT_EQ(unranked_sentence(c), "") << "nor listed as left out";
}

std::string chosen(const Comparison& c) { return advice_text(c, {}, advise(c, {})); }

TEST(Orders, IncompleteDataAreNotTested) {
  Study study = family();
  study.plan = plan_of(study.runs);
  study.runs.erase(study.runs.begin());
  const Compared c(std::move(study));
  EXPECT_FALSE(c.decision);
  EXPECT_EQ(first_sentences(c).at(0), words("ranking.incomplete", 1));
  EXPECT_TRUE(has(chosen(c), "1 run is missing")) << chosen(c);
}

// 25 and 26 a target are equal for a user, though on every family the first needs less.
TEST(Orders, MethodsWithinTheMarginAreBothNamed) {
  Study study;
  for (const char* problem : {"p", "q", "r", "s", "t", "u"})
    for (const auto& [optimizer, work] : {std::pair{"a", 25}, {"b", 26}})
      study.runs.push_back(
          record_of({.problem = problem, .optimizer = optimizer, .work_per_hit = work}));
  const Compared c(study);
  EXPECT_TRUE(has(verdict(c).at(0), words("ranking.scored", "b", 0.99, 6))) << verdict(c)[0];
  EXPECT_TRUE(has(chosen(c), "use a or b")) << chosen(c);
  EXPECT_TRUE(has(verdict(c).at(2), "2 methods solve 6"));
  for (Record& record : study.runs) record.request.problem.options.set("goal", std::string("fit"));
  EXPECT_TRUE(has(chosen(Compared(study)), words("advice.fit")));
  std::erase_if(study.runs, [](const Record& r) { return r.request.optimizer.name == "b"; });
  EXPECT_TRUE(has(chosen(Compared(study)), words("advice.only")));
}

// One sentence of at most 60 words, and no other that contradicts it: kin is in the group, second
// is not.
TEST(Orders, AllSentencesFollowFromOneDecision) {
  const Compared c(family());
  EXPECT_FALSE(c.decision->is_lead);
  EXPECT_TRUE(c.decision->places[1].is_in_group);
  EXPECT_FALSE(c.decision->places[2].is_in_group);
  const std::string first = verdict(c).at(0);
  EXPECT_LE(std::ranges::count(first, ' '), 59) << first;
  EXPECT_EQ(leader_table(c).reading, first);
  const std::vector<Reading> facts = ranking_facts(c);
  EXPECT_TRUE(has(facts[0].text, "first, kin")) << facts[0].text;
  EXPECT_FALSE(has(facts[0].text, "second")) << facts[0].text;
  EXPECT_TRUE(has(facts[1].text, "because first needs less")) << facts[1].text;
}

// Seeds are instances. By time another is first, which is said of runs that were timed alone and
// took 50 ms.
TEST(Orders, TheFirstSentenceSaysHowItsRunsDifferAndTimesRankOnlyWhereTheyAreTold) {
  Study study = family();
  const auto by_time = [&](Real seconds, std::int64_t jobs) {
    for (Record& record : study.runs) {
      const bool is_kin = record.request.optimizer.name == "kin";
      for (Real& each : record.hits->wall_seconds) each = is_kin ? 1e-3 : 1;
      record.summary.wall_seconds = seconds;
      record.provenance.run.concurrent_jobs = jobs;
      record.provenance.run.is_exclusive = false;
    }
    const Compared c(study);
    return std::ranges::any_of(c.decision->choices, [](const Choice& choice) {
      return choice.varied == Varied::measure && choice.value == name_of(Measure::time);
    });
  };
  EXPECT_TRUE(by_time(1, 1));
  EXPECT_FALSE(by_time(1, 2));
  EXPECT_FALSE(by_time(0.04, 1));
  EXPECT_EQ(first_sentences(Compared(study, {.by = Measure::time})).at(0),
            words("ranking.short-time"));
  for (const Record& record : std::vector(study.runs)) {
    study.runs.push_back(record);
    study.runs.back().request.seed = 1;
  }
  EXPECT_TRUE(has(verdict(Compared(study)).at(0), "2 instances"));
}

TEST(Orders, OneAlgorithmTwiceIsTiedOnTheFirstScreen) {
  Study study;
  for (int i = 0; i < 10; ++i)
    for (const char* optimizer : {"gd", "gd-again", "slow"})
      study.runs.push_back(record_of({.problem = std::string(1, static_cast<char>('a' + i)),
                                      .optimizer = optimizer,
                                      .work_per_hit = optimizer[0] == 's' ? 9 : 2}));
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(c.decision->tied, 2U);
  EXPECT_FALSE(c.decision->is_lead);
  EXPECT_TRUE(has(verdict(c).at(0), "tied")) << verdict(c).at(0);
  const Section section = standings_section(c);
  const Table& table = section.tables[0];
  EXPECT_EQ(table.rows[0][0].text, "1");
  EXPECT_EQ(table.rows[1][0].text, "1");
  EXPECT_EQ(table.rows[2][0].text, "3");
}

// Three seeds: 2, 4 and 6 a target against 3, 5 and 5, their ranges overlapping.
TEST(Orders, SeedsAreComparedInPairs) {
  Study study;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const auto k = static_cast<std::int64_t>(seed);
    study.runs.push_back(record_of({.optimizer = "a", .seed = seed, .work_per_hit = 2 + 2 * k}));
    study.runs.push_back(
        record_of({.optimizer = "b", .seed = seed, .work_per_hit = k == 0 ? 3 : 5}));
  }
  const std::string text = curve_reading(compare_optimizers(study), 0);
  EXPECT_TRUE(has(text, "on 2 of 3 seeds")) << text;
  EXPECT_TRUE(text.starts_with(words("curve.few", 3))) << text;
  const std::string alone = curve_reading(Compared({record_of({})}), 0);
  EXPECT_TRUE(alone.starts_with("gd needs 60 forward")) << alone;
}

// Rows of one method at its defaults and at tuned rates.

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
  EXPECT_TRUE(has(document_of(c).headline, "3 cells")) << document_of(c).headline;
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
  EXPECT_TRUE(has(section.readings[1].text, " 1 of 1 tuned rate,")) << section.readings[1].text;
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

// The label of an external program is its own name unless that name is taken.
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
  const std::string page = readable_html(document);
  EXPECT_TRUE(has(page, words("marks.foreign")));
  for (const std::string& text : {page, markdown_report(document), terminal_table(document)})
    EXPECT_TRUE(has(text, "scipy-lm ‡"));
  for (const std::string& text : {markdown_report(document), terminal_table(document)})
    EXPECT_TRUE(has(text, words("marks.foreign")));
}

// Two commands of one script have one name: their headings are the commands.
TEST(Labels, OfTwoProblemsOfOneNameAreTheirCommands) {
  Study study;
  for (const char* spec : {"process[command=\"decay 1\"]", "process[command=\"decay 2\"]"}) {
    study.runs.push_back(record_of({.problem = spec}));
    study.runs.back().foreign.problem =
        Foreign{.door = "process", .command = spec, .label = "decay"};
  }
  const Comparison c = compare_optimizers(study);
  ASSERT_EQ(c.problems.size(), 2U);
  EXPECT_NE(problem_name(c.problems[0]), problem_name(c.problems[1]));
  EXPECT_TRUE(has(problem_name(c.problems[1]), "decay 2"));
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
