// Which settings rank, which stand in tables of their own, and what prices change.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/oracle.h"
#include "core/results/ranking.h"
#include "core/seeds.h"
#include "reports/sections/contrasts.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

Sheet problem_sheet(const std::string& problem, const std::string& group) {
  return {.kind = "problem", .name = problem, .spec = problem, .group = group};
}

// On physics a is ahead of b and b of c; elsewhere c is ahead, and a does not solve one.
Study physics_and_others() {
  Study study;
  for (const char* name : {"p", "q", "r", "s", "t", "valley", "bowl"}) {
    const std::string problem(name);
    const bool is_physics = problem.size() == 1;
    study.sheets.push_back(problem_sheet(problem, is_physics ? "physics" : "classical"));
    for (const auto& [optimizer, work] : {std::pair{"a", 1}, {"b", 3}, {"c", 9}})
      study.runs.push_back(record_of({.problem = problem,
                                      .optimizer = optimizer,
                                      .hits = problem == "bowl" && work == 1 ? 10U : 51U,
                                      .work_per_hit = is_physics ? work : 10 - work}));
  }
  return study;
}

const Table& table_of(const Section& section, const std::string& id) {
  return *std::ranges::find(section.tables, id, &Table::id);
}

TEST(RankedSettings, AreThoseOfPhysicsAloneWhereThereAreAny) {
  const Compared c(physics_and_others());
  EXPECT_EQ(c.order.settings.size(), 5U);
  EXPECT_EQ(c.sanity.settings.size(), 2U);
  for (const auto& [s, score] : {std::pair{0, 1.0}, {1, 1 - std::log2(3) / 6}})
    EXPECT_NEAR(c.optimizers[static_cast<std::size_t>(s)].tightest().score, score, 1e-12);
  const Section section = standings_section(c);
  const Table& sanity = table_of(section, "sanity");
  EXPECT_EQ(at(sanity, "c", "solved"), "2/2");
  EXPECT_EQ(at(sanity, "c", "median work"), "30");
  EXPECT_EQ(at(sanity, "a", "solved"), "1/2");
  EXPECT_EQ(at(sanity, "a", "median work"), "✗");
  EXPECT_TRUE(
      has(joined(verdict(c)), words("ranking.sanity", 2, " " + words("ranking.sanity-table", 2))));
  Study study = physics_and_others();
  for (Sheet& sheet : study.sheets) sheet.group = "classical";
  const Compared others(std::move(study));
  EXPECT_EQ(others.order.settings.size(), 7U) << "of a study without physics all rank";
  EXPECT_EQ(left_out_text(others), "");
}

// Seven problems, of which two share an operator and two are linear.
TEST(RankedSettings, OfOneFamilyAreOneWitnessAndLinearOnesStandApart) {
  Study study;
  for (const char* name : {"o", "p", "q", "r", "s", "t", "u"}) {
    Sheet sheet = problem_sheet(name, "physics");
    sheet.family = *name < 'q' ? "laplacian" : name;
    sheet.linear = *name < 'q';
    study.sheets.push_back(sheet);
    for (const auto& [optimizer, work] : {std::pair{"a", 1}, {"b", *name < 'q' ? 3 : 9}, {"c", 9}})
      study.runs.push_back(
          record_of({.problem = name, .optimizer = optimizer, .work_per_hit = work}));
  }
  const Compared c(std::move(study));
  EXPECT_EQ(c.decision->families, 6U);
  EXPECT_EQ(c.decision->least_p, 1.0 / 32);
  EXPECT_EQ(c.decision->fewest_wins(), 6U);
  EXPECT_EQ(c.decision->group_sizes().first, 1U);
  EXPECT_EQ(c.decision->group_sizes().second, 3U) << "without a family, five decide nothing";
  const auto nonlinear = std::ranges::find(c.decision->choices, Varied::linear, &Choice::varied);
  ASSERT_NE(nonlinear, c.decision->choices.end());
  EXPECT_EQ(nonlinear->group, 3U);
  const Section section = standings_section(c);
  EXPECT_EQ(at(table_of(section, "linear"), "b", "linear: solved"), "2/2");
  EXPECT_EQ(at(table_of(section, "linear"), "b", "nonlinear: solved"), "5/5");
}

// Errors in x from 1 down to 1e-5, with floors by seed. The goal is 1.1 times the median floor.
Study with_floors(const std::vector<Real>& floors) {
  Study study = physics_and_others();
  for (std::size_t seed = 0; seed < floors.size(); ++seed)
    for (const char* optimizer : {"a", "b", "c"}) {
      Record& record = study.runs.emplace_back(
          record_of({.problem = "u", .optimizer = optimizer, .seed = seed}));
      record.aim = Aim::x;
      record.x_scale = 1;
      record.x_floor = floors[seed];
      record.request.budget.work = 100;
    }
  study.sheets.push_back(problem_sheet("u", "physics"));
  return study;
}

TEST(RankedSettings, LeaveOutAnIllPosedOneAndShowItsErrorsAgainstWork) {
  EXPECT_EQ(Compared(with_floors({0.09, 0.09, 0.9})).order.settings.size(), 6U);
  const Compared c(with_floors({0.01, 0.092, 0.9}));
  EXPECT_EQ(c.order.settings.size(), 5U);
  EXPECT_EQ(left_out_text(c), words("ranking.sanity", 2, " " + words("ranking.sanity-table", 2)) +
                                  " " + words("ranking.ill-posed", 1, "u"));
  const Section section = standings_section(c);
  const Table& table = table_of(section, "ill-posed");
  ASSERT_EQ(table.rows.size(), 3U);
  // 2 a target, so τ = 10^(−12/5), 10^(−25/5) and 10^(−50/5), of which x has the root
  EXPECT_EQ(table.rows[0][1].text, "0.0631; 0.00316; 1e-05");
  EXPECT_TRUE(has(table.columns[1], "0.092")) << table.columns[1];
}

// Ten forwards a target (a) against two forwards and a Jacobian of nominal price 10.
TEST(RankedSettings, HalfAndTwiceThePriceOfEachOracleAreOtherChoices) {
  Study study;
  for (const char* problem : {"p", "q", "r", "s"})
    for (const int each : {0, 1}) {
      Record& record = study.runs.emplace_back(record_of({.problem = problem,
                                                          .optimizer = each == 0 ? "a" : "b",
                                                          .work_per_hit = each == 0 ? 10 : 12}));
      record.prices.fill(1);
      record.prices[static_cast<std::size_t>(Oracle::jacobian)] = 10;
      for (int j = 0; j < 51; ++j) {
        record.hits->counts["forward"].push_back(j * (10 - 8 * each));
        record.hits->counts["jacobian"].push_back(j * each);
      }
    }
  const Compared c(std::move(study));
  std::map<std::string, bool> kept;
  for (const Choice& choice : c.decision->choices)
    if (choice.varied == Varied::prices) kept[choice_text(choice)] = choice.is_kept;
  EXPECT_EQ(kept,
            (std::map<std::string, bool>{{"with jacobian at half its cost", false},  // 10 and 7
                                         {"with jacobian at twice its cost", true},
                                         {"with forward at twice its cost", false},
                                         {"with forward at half its cost", true}}));
}

// A tenth of a second of forwards within 0.4; the run whose Jacobians have no price is left out.
TEST(RankedSettings, OwnTimeIsWhatMeasuredCallsDoNotExplain) {
  Study study;
  study.sheets.push_back(problem_sheet("p", "physics"));
  study.sheets[0].prices = MeasuredPrices{.forward_seconds = 1e-3, .oracles = {}};
  for (const std::uint64_t seed : {0, 1}) {
    Record& record = study.runs.emplace_back(record_of({.problem = "p", .seed = seed}));
    record.counts[static_cast<std::size_t>(Oracle::forward)] = record.summary.work = 100;
    record.counts[static_cast<std::size_t>(Oracle::jacobian)] = static_cast<int>(seed);
    record.summary.processor_seconds = 0.4;
  }
  const Spread own = own_time(Compared(std::move(study)), 0);
  EXPECT_EQ(own.n, 1U);
  EXPECT_NEAR(own.median, 0.75, 1e-12);
}

// --- a suite that names contrasts

Record judged_by_x(const std::string& problem, const std::string& optimizer, bool is_solved) {
  Record record = record_of({.problem = problem,
                             .optimizer = optimizer,
                             .hits = is_solved ? 51U : 10U,
                             .status = Status::budget});
  record.aim = Aim::x;
  record.x_scale = 1;
  record.curve.x_error = record.curve.loss;
  record.summary.x_error = record.summary.loss;
  return record;
}

// The methods of the suite's contrasts on so many nonlinear families, where adam solves none,
// beside a linear control and an ill-posed problem with noise.
Study contest_of(std::size_t families) {
  Study study;
  study.plan.suites = {"contest@3"};
  std::vector<std::string> problems = {"control", "blurred"};
  for (std::size_t i = 0; i < families; ++i) problems.push_back("f" + std::to_string(i));
  for (const std::string& problem : problems) {
    study.sheets.push_back(problem_sheet(problem, "physics"));
    study.sheets.back().linear = problem == "control";
    for (const char* method : {"adam", "nlopt-lbfgs", "levenberg-marquardt", "hig", "ssbroyden"}) {
      study.runs.push_back(judged_by_x(problem, method, std::string(method) != "adam"));
      if (problem != "blurred") continue;
      study.runs.back().request.problem.options.set("noise", 0.01);
      study.runs.back().x_floor = 0.5;
      if (std::string(method) != "hig") study.runs.back().status = Status::discrepancy;
    }
  }
  return study;
}

constexpr Yardstick kWithContrasts{.has_contrasts = true};

TEST(Contrasts, LeadTheFirstScreenAndEachGroupStandsApart) {
  const Compared c(contest_of(8), kWithContrasts);
  EXPECT_TRUE(has_contrasts(*c.study));
  EXPECT_EQ(c.order.settings.size(), 8U);
  EXPECT_EQ(c.sanity.settings.size(), 1U);
  const std::string better = words("contrasts.worse", "adam", "nlopt-lbfgs", "", "");
  EXPECT_TRUE(has(first_sentences(c).at(0), better)) << first_sentences(c)[0];
  EXPECT_TRUE(first_sentences(c).back().starts_with(words("ranking.second")));
  const Section section = standings_section(c);
  const Table& table = table_of(section, "contrasts");
  EXPECT_EQ(at(table, "adam against nlopt-lbfgs", "both solve"), "– (0)");
  EXPECT_EQ(at(table, "levenberg-marquardt against nlopt-lbfgs", "both solve"), "1 (8)");
  EXPECT_EQ(at(table, "hig against levenberg-marquardt", "decision"), words("contrasts.untested"));
  EXPECT_EQ(at(table_of(section, "sanity"), "hig", "solved"), "1/1");
  const std::string text = joined(verdict(c));
  EXPECT_TRUE(has(text, words("noise-level.range", "adam", "0.03", "0.03"))) << text;
  EXPECT_TRUE(has(text, words("noise-level.never", words("noise-level.never-in", "hig", 1, 1))));
}

// Seven families have two runs, one of them a run alone: the sentence says so, and bounds are of
// families.
TEST(Contrasts, NumbersOfSeedsAndBoundsOfFailuresAreThoseOfTheSettings) {
  Study study = contest_of(8);
  const std::size_t count = study.runs.size();
  for (std::size_t i = 0; i < count; ++i) {
    Record again = study.runs[i];
    again.request.seed = seed_of(1, 0);
    again.cell += "b";
    if (again.request.problem.name != "f0") study.runs.push_back(std::move(again));
  }
  study.plan.cells = plan_of(study.runs).cells;
  const Compared c(std::move(study), kWithContrasts);
  EXPECT_TRUE(has(joined(verdict(c)), words("ranking.instances", "1 to 2", "problem")))
      << joined(verdict(c));
  EXPECT_EQ(at(contrast_table(c), "adam against nlopt-lbfgs", "failures of the first"),
            words("contrasts.failures", 15, 15, 8, 8, "63 %", "100 %"));
}

TEST(Contrasts, OfOneOrTwoFamiliesDecideNothingAndOfNoneSayNothing) {
  for (const std::size_t families : {1U, 2U, 5U}) {
    const Compared c(contest_of(families), kWithContrasts);
    const std::string index = at(contrast_table(c), "adam against nlopt-lbfgs", "index");
    const std::size_t from = index.find('(') + 1, to = index.find(" to ");
    const std::string undecided =
        words("contrasts.undecided", "adam", "nlopt-lbfgs", index.substr(from, to - from),
              index.substr(to + 4, index.size() - to - 5)) +
        words("contrasts.solves-none", "adam", families);
    EXPECT_EQ(first_sentences(c).at(0),
              words("contrasts.decided", families, words("contrasts.defaults"), undecided));
    EXPECT_TRUE(has(first_sentences(c).at(1), words("contrasts.no-power", families)));
  }
  EXPECT_TRUE(contrast_sentences(Compared(contest_of(0), kWithContrasts)).empty());
}

TEST(Contrasts, OfMissingRunsOrMethodsAreNotTested) {
  Study study = contest_of(8);
  study.plan.cells = plan_of(study.runs).cells;
  Study without = study;
  study.runs.pop_back();
  const Compared lacking(std::move(study), kWithContrasts);
  EXPECT_EQ(contrast_sentences(lacking), std::vector{words("contrasts.incomplete", 1)});
  const auto is_hig = [](const Record& run) { return run.request.optimizer.name == "hig"; };
  std::erase_if(without.runs, is_hig);
  without.plan.cells = plan_of(without.runs).cells;
  const Compared c(std::move(without), kWithContrasts);
  EXPECT_EQ(contrast_sentences(c), std::vector{words("contrasts.absent", "hig", 1)});
}

}  // namespace
}  // namespace isoline::reports
