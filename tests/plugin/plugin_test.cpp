// What shared libraries bring by the struct of core/foreign/isoline.h: the same runs as the tree's
// own, and a sentence that names the library wherever it breaks a law.
#include <gtest/gtest.h>

#include <cmath>

#include "problems/conformance.h"
#include "tests/plugin/libraries.h"

namespace isoline::benchmarks {

using problems::examine;
using problems::Finding;
namespace {

// All that happened, to the last bit, whatever the components are called.
void expect_same_run(const Record& one, const Record& other) {
  const std::string title = title_of(one) + " and " + title_of(other);
  EXPECT_EQ(one.status, other.status) << title;
  EXPECT_EQ(one.counts, other.counts) << title;
  EXPECT_EQ(one.verified, other.verified) << title;
  EXPECT_EQ(one.found, other.found) << title;
  EXPECT_EQ(one.curve.iteration, other.curve.iteration) << title;
  EXPECT_EQ(one.curve.work, other.curve.work) << title;
  EXPECT_EQ(one.curve.loss, other.curve.loss) << title;
  for (std::size_t i = 0; i < one.curve.x_error.size(); ++i)
    EXPECT_TRUE(one.curve.x_error[i] == other.curve.x_error[i] ||
                (std::isnan(one.curve.x_error[i]) && std::isnan(other.curve.x_error[i])))
        << title;
  EXPECT_EQ(one.curve.gradient_norm, other.curve.gradient_norm) << title;
  EXPECT_EQ(one.curve.step_norm, other.curve.step_norm) << title;
  ASSERT_TRUE(one.trajectory && other.trajectory) << title;
  EXPECT_EQ(one.trajectory->x, other.trajectory->x) << title;
  EXPECT_EQ(one.trajectory->y, other.trajectory->y) << title;
  EXPECT_GT(one.curve.iteration.size(), 5U) << title;
}

TEST(Plugin, AProblemGivesTheSameTraceAsTheTreesOwnBitForBit) {
  const Catalog catalog = catalog_with({"rosenbrock.so"});
  const std::vector<std::string> methods = {"levenberg-marquardt", "gd[rate=1e-3]", "ceres-lm",
                                            "nlopt-neldermead", "nlopt-lbfgs"};
  const FinishedMatrix ours = run(catalog, {"rosenbrock"}, methods),
                       theirs = run(catalog, {"rosenbrock-c"}, methods);
  ASSERT_EQ(ours.records.size(), methods.size());
  ASSERT_EQ(theirs.records.size(), methods.size());
  for (std::size_t i = 0; i < methods.size(); ++i)
    expect_same_run(ours.records[i], theirs.records[i]);
  EXPECT_TRUE(theirs.records[0].verified.at("1e-6") == true);
}

TEST(Plugin, AMethodGivesTheSameTraceAsTheTreesOwnBitForBit) {
  const Catalog catalog = catalog_with({"gradient_descent.so", "trials.so"});
  const std::vector<std::string> problems = {"rosenbrock", "square", "trial-products"};
  const FinishedMatrix ours = run(catalog, problems, {"gd[rate=1e-3]"}),
                       theirs = run(catalog, problems, {"gd-c[rate=1e-3]"});
  ASSERT_EQ(ours.records.size(), problems.size());
  ASSERT_EQ(theirs.records.size(), problems.size());
  for (std::size_t i = 0; i < problems.size(); ++i)
    expect_same_run(ours.records[i], theirs.records[i]);
}

TEST(Plugin, AWholeSolveReportsItsIterationsAndSaysThatItConverged) {
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all = run(catalog, {"trial-products"}, {"trial-solve"});
  ASSERT_EQ(all.records.size(), 1U);
  const Record& record = all.records[0];
  EXPECT_TRUE(record.status == Status::converged || record.status == Status::target)
      << record.message;
  EXPECT_EQ(record.verified.at("1e-6"), true);
  EXPECT_GT(record.summary.iterations, 3);
  EXPECT_LT(record.summary.iterations, 20);
}

TEST(Plugin, ASolveThatIsToldThatTheRunIsOverEndsByItsBudget) {
  const Catalog catalog = catalog_with({"trials.so"});
  const Suite suite{.name = "plugin",
                    .title = "",
                    .blocks = {{.problems = {"trial-products"},
                                .optimizers = {"trial-solve"},
                                .seeds = {0},
                                .budget = {.iterations = 2, .target = 0}}}};
  const FinishedMatrix all(catalog, suite, {});
  ASSERT_EQ(all.records.size(), 1U);
  EXPECT_EQ(all.records[0].status, Status::budget) << all.records[0].message;
  EXPECT_EQ(all.records[0].summary.iterations, 2);
}

TEST(Plugin, SoundProblemsHoldWhatEveryProblemMust) {
  const Catalog catalog = catalog_with({"rosenbrock.so", "trials.so"});
  for (const char* name : {"rosenbrock-c", "trial-products", "trial-forward"}) {
    const Problem problem =
        make_problem(catalog, complete_problem(catalog, name, OptionValues()), 1);
    RandomStream stream(1, name, "check");
    const std::vector<Finding> findings = examine(problem, stream);
    EXPECT_GE(findings.size(), 2U) << name;
    for (const Finding& finding : findings)
      EXPECT_TRUE(finding.holds()) << name << ": " << finding.property << " " << finding.figure;
  }
}

TEST(Plugin, AProblemOfForwardAloneIsInapplicableToWhoAsksForMore) {
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all =
      run(catalog, {"trial-forward"}, {"gd", "levenberg-marquardt", "nlopt-neldermead"});
  ASSERT_EQ(all.records.size(), 3U);
  EXPECT_EQ(all.records[0].status, Status::inapplicable);
  EXPECT_EQ(all.records[1].status, Status::inapplicable);
  EXPECT_NE(all.records[2].status, Status::inapplicable);
  EXPECT_LT(all.records[2].summary.loss, all.records[2].summary.start_loss);
}

TEST(Plugin, ACrashCostsItsCellAlone) {
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all =
      run(catalog, {"square", "trial-crash"}, {"newton", "levenberg-marquardt"});
  ASSERT_EQ(all.records.size(), 4U);
  for (const Record& record : all.records) {
    const bool is_ours = record.request.problem.name == "square";
    EXPECT_EQ(record.status == Status::crashed,
              !is_ours && record.request.optimizer.name == "levenberg-marquardt")
        << title_of(record) << ": " << name_of(record.status);
  }
}

TEST(Plugin, TheRecordSaysWhoComputed) {
  const Catalog catalog = catalog_with({"rosenbrock.so", "gradient_descent.so"});
  const FinishedMatrix all = run(catalog, {"rosenbrock-c"}, {"gd-c", "gd"});
  ASSERT_EQ(all.records.size(), 2U);
  const ForeignParts& both = all.records[0].foreign;
  ASSERT_TRUE(both.problem && both.optimizer);
  EXPECT_EQ(both.problem->door, "plugin");
  EXPECT_EQ(both.problem->command, kPlugins + "/rosenbrock.so");
  EXPECT_EQ(both.problem->digest.size(), 16U);
  EXPECT_NE(both.problem->digest, both.optimizer->digest);
  EXPECT_FALSE(all.records[1].foreign.optimizer);
}

}  // namespace
}  // namespace isoline::benchmarks
