// What the page chooses from: standings to every target by every measure, labels that are brief,
// learned problems at equal work, kinds as colours.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <sstream>

#include "core/results/ranking.h"
#include "core/results/table.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

const std::vector<Result> kThree = {
    {"a", "gd", 4},   {"a", "adam", 2}, {"a", "sip", 1},  {"b", "gd", 1},    {"b", "adam", 3},
    {"b", "sip", 0},  {"c", "gd", 5},   {"c", "adam", 5}, {"c", "sip", 2},   {"d", "gd", 2},
    {"d", "adam", 0}, {"d", "sip", 1},  {"e", "gd", 64},  {"e", "adam", 30}, {"e", "sip", 1}};

TEST(Ladders, AreTheStandingsOfTheReportAtItsTolerances) {
  const Study study = study_of(kThree);
  const Comparison c = compare_optimizers(study);
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    for (const Ranked& ranked : standings_to(c, Measure::work, kTolerances[t].rung)) {
      const Standing& own = c.optimizers[ranked.optimizer].standings[t];
      EXPECT_EQ(ranked.standing.score, own.score);
      EXPECT_EQ(ranked.standing.solved, own.solved);
      EXPECT_EQ(ranked.standing.wins, own.wins);
      EXPECT_EQ(ranked.standing.typical, own.typical);
      EXPECT_EQ(ranked.standing.reached, own.reached);
    }
}

TEST(Ladders, ByAnotherMeasureAreTheStandingsOfAReportByIt) {
  const Study study = study_of(kThree);
  const Comparison by_work = compare_optimizers(study);
  const Comparison by_time = compare_optimizers(study, yardstick_at(Measure::time, 1e-6));
  for (const Ranked& ranked : standings_to(by_work, Measure::time, kTolerances[kTightest].rung)) {
    const std::string& label = by_work.optimizers[ranked.optimizer].label;
    const auto same = std::ranges::find(by_time.optimizers, label, &OptimizerAxis::label);
    EXPECT_DOUBLE_EQ(ranked.standing.score, same->tightest().score) << label;
  }
}

TEST(Scores, StandWithinTheirIntervals) {
  const Study study = study_of(kThree);
  const Comparison c = compare_optimizers(study);
  const std::vector<Interval> intervals = score_intervals(c);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    EXPECT_LE(intervals[s].low, c.optimizers[s].tightest().score);
    EXPECT_GE(intervals[s].high, c.optimizers[s].tightest().score);
  }
}

TEST(MethodPairs, TurnWhenTheirMethodsDo) {
  const Study study = study_of(kThree);
  const Comparison c = compare_optimizers(study);
  for (const MethodPair& pair : all_pairs(c)) {
    const Costs costs = median_costs(c, kTightest);
    Families families;
    for (const auto& [name, problems] : problems_by_name(c)) families.push_back(problems);
    const Pairing turned = pairing_of(costs, families, pair.b, pair.a);
    EXPECT_EQ(turned.wins, pair.pairing.losses);
    EXPECT_EQ(turned.ties, pair.pairing.ties);
    EXPECT_NEAR(turned.typical() * pair.pairing.typical(), 1, 1e-12);
    EXPECT_NEAR(turned.interval()[0] * pair.pairing.interval()[1], 1, 1e-12);
  }
}

TEST(BriefLabels, ShowWhatDiffersAndNoTwoBecomeTheSame) {
  const std::vector<std::string> labels = {
      "adam",
      "gd[rate=0.1]",
      "sip[inverse=newton,network-optimizer=adam[rate=1e-3],proxy=l1]",
      "sip[inverse=analytic,network-optimizer=adam[rate=1e-3],proxy=l1]",
      "rescaled[by=truth,network-optimizer=adam[rate=1e-3]], tuned",
      "no[specification"};
  EXPECT_EQ(
      brief_labels(labels),
      (std::vector<std::string>{"adam", "gd[rate=0.1]", "sip[inverse=newton]",
                                "sip[inverse=analytic]", "rescaled, tuned", "no[specification"}));
  const std::vector<std::string> alike = {"rescaled[by=truth,network-optimizer=adam[rate=1e-3]]",
                                          "rescaled"};
  EXPECT_NE(brief_labels(alike)[0], brief_labels(alike)[1]);
}

Record learned(const char* optimizer, std::vector<std::int64_t> work, std::vector<Real> x_error) {
  Record record = record_of({.problem = "sine[mode=learn]", .optimizer = optimizer});
  record.request.problem.is_learned = true;
  record.curve = {};
  record.hits.reset();
  for (std::size_t i = 0; i < work.size(); ++i) {
    record.curve.iteration.push_back(static_cast<std::int64_t>(i));
    record.curve.work.push_back(work[i]);
    record.curve.wall_seconds.push_back(static_cast<Real>(i));
    record.curve.loss.push_back(x_error[i] / 2);
    record.curve.x_error.push_back(x_error[i]);
  }
  record.curve.processor_seconds = record.curve.gradient_norm = record.curve.step_norm =
      record.curve.wall_seconds;
  record.summary.work = work.back();
  record.summary.iterations = record.request.budget.iterations = record.curve.iteration.back();
  record.summary.x_error = x_error.back();
  return record;
}

// The errors in x of adam and sip at the least work that any method was allowed: at 200 adam has 2,
// at the end it would have 0.1. A run that failed before is infinite. One that diverged after two
// of six steps counts with its last finite value, is marked, and lowers the work of no other.
TEST(EqualWork, IsTheLeastThatAnyMethodWasAllowed) {
  const struct {
    Record adam, sip;
    Status adam_ends, sip_ends;
    std::int64_t adam_steps, sip_steps;
    Real work, adam_error, sip_error;
  } cases[] = {{learned("adam", {0, 100, 200, 300}, {4, 3, 2, 0.1}),
                learned("sip", {0, 80, 160, 240}, {4, 2, 1, 0.5}), Status::budget, Status::budget,
                3, 3, 240, 2, 0.5},
               {learned("adam", {0, 100}, {4, 3}), learned("sip", {0, 50, 200}, {4, 2, 1}),
                Status::crashed, Status::budget, 3, 2, 0, kNever, 1},
               {learned("adam", {0, 100, 200, 300, 400, 500, 600}, {4, 3, 2, 1, 0.5, 0.3, 0.2}),
                learned("sip", {0, 90, 180}, {4, 2, NAN}), Status::budget, Status::diverged, 6, 6,
                540, 0.3, 2}};
  for (const auto& each : cases) {
    Study study;
    study.runs = {each.adam, each.sip};
    study.runs[0].status = each.adam_ends;
    study.runs[1].status = each.sip_ends;
    study.runs[0].request.budget.iterations = each.adam_steps;
    study.runs[1].request.budget.iterations = each.sip_steps;
    const Comparison c = compare_optimizers(study);
    const EqualWork equal = equal_work(c, 0);
    if (each.work > 0) {
      EXPECT_EQ(equal.work, each.work);
    }
    for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
      const bool is_sip = c.optimizers[s].label == "sip";
      EXPECT_EQ(equal.methods[s]->x_error.median, is_sip ? each.sip_error : each.adam_error);
      EXPECT_EQ(equal.methods[s]->diverged, is_sip && each.sip_ends == Status::diverged ? 1U : 0U);
    }
    const bool is_sip_nearest = each.sip_error < each.adam_error;
    EXPECT_EQ(c.optimizers[equal.nearest_first()[0]].label, is_sip_nearest ? "sip" : "adam");
  }
}

// A tolerance of the loss says little of a network.
TEST(Order, IsOfProblemsThatAreNotLearned) {
  Study study = study_of(kThree);
  study.runs.push_back(learned("adam", {0, 100}, {4, 3}));
  study.runs.push_back(learned("sip", {0, 50}, {4, 2}));
  const Comparison c = compare_optimizers(study);
  for (const std::size_t p : c.order.settings) EXPECT_FALSE(c.problems[p].is_learned);
  EXPECT_EQ(c.order.settings.size(), 5U);
}

// A colour is of a kind in every report; within it no two look alike.
TEST(Kinds, HaveOneColourAndTellTheirMethodsApart) {
  Comparison c;
  const Sheet adaptive{.kind = "optimizer", .name = "adam", .mathematics = "adaptive"};
  for (const char* label : {"adam", "adam, tuned", "adagrad", "lion", "shampoo", "adan"})
    c.optimizers.push_back({.label = label, .sheet = &adaptive});
  c.optimizers.push_back({.label = "mine", .method = "mine"});
  std::set<std::string> looks;
  std::istringstream rules(kind_rules(c));
  std::string rule;
  for (std::size_t s = 0; std::getline(rules, rule); ++s) {
    EXPECT_NE(rule.find(s + 1 < c.optimizers.size() ? "var(--adaptive)" : "var(--other)"),
              std::string::npos);
    looks.insert(rule.substr(rule.find('{')));
  }
  EXPECT_EQ(looks.size(), c.optimizers.size());
}

}  // namespace
}  // namespace isoline::reports
