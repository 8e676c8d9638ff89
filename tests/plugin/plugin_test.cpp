// What shared libraries bring by the struct of clients/c/isoline.h: the same runs as the tree's
// own, and a sentence that names the library wherever it breaks a law.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "benchmarks/plan/plugins.h"
#include "core/foreign/plugin_library.h"
#include "problems/conformance.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {

using problems::examine;
using problems::Finding;
namespace {

const std::string kPlugins = ISOLINE_PLUGINS;
const std::string kTrials = kPlugins + "/trials.so";

// As long as it lives one thing is wrong with the first component of trials.so.
class Defect {
 public:
  explicit Defect(const char* name) { setenv("ISOLINE_DEFECT", name, 1); }
  ~Defect() { unsetenv("ISOLINE_DEFECT"); }
  Defect(const Defect&) = delete;
  Defect& operator=(const Defect&) = delete;
};

Catalog catalog_with(const std::vector<std::string>& libraries) {
  Catalog catalog = builtin_catalog();
  for (const std::string& library : libraries) add_plugin(catalog, kPlugins + "/" + library);
  return catalog;
}

FinishedMatrix run(const Catalog& catalog, const std::vector<std::string>& problems,
                   const std::vector<std::string>& optimizers) {
  const Suite suite{.name = "plugin",
                    .title = "",
                    .blocks = {{.problems = problems,
                                .optimizers = optimizers,
                                .seeds = {0},
                                .budget = {.iterations = 300, .work = 3000}}}};
  return {catalog, suite, {}};
}

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
  const FinishedMatrix all = run(catalog, {"square", "trial-crash"}, {"newton", "gd"});
  ASSERT_EQ(all.records.size(), 4U);
  for (const Record& record : all.records) {
    const bool is_ours = record.request.problem.name == "square";
    EXPECT_EQ(record.status == Status::crashed, !is_ours && record.request.optimizer.name == "gd")
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

// --- laws

// The sentence about a defect, of the library's loading or of its first problem's making.
std::string complaint(const char* defect) {
  const Defect here(defect);
  try {
    Catalog catalog;
    add_plugin(catalog, kTrials);
    make_problem(catalog, complete_problem(catalog, "trial-products", OptionValues()), 0);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing";
}

struct Law {
  const char *defect, *sentence;
};

const Law kLaws[] = {
    {"version", "no. 0: a component must be of version 1 of isoline.h, got 2"},
    {"bytes", "`bytes` must be sizeof(isoline_component), "},
    {"null name", "no. 0: `name` is null"},
    {"bad name", "`name` must be lower-case letters, digits and hyphens, 64 at most"},
    {"empty title", "trial-products: `title` is empty"},
    {"null source", "trial-products: `source` is null"},
    {"null dimension", "its capabilities promise dimension(), which is null"},
    {"null instance", "its capabilities promise instance(), which is null"},
    {"null forward", "its capabilities promise forward(), which is null"},
    {"null pushforward", "its capabilities promise pushforward(), which is null"},
    {"null pullback", "its capabilities promise pullback(), which is null"},
    {"null jacobian", "its capabilities promise jacobian(), which is null"},
    {"null inverse", "its capabilities promise inverse(), which is null"},
    {"null step", "its capabilities promise step(), which is null"},
    {"inverse of no kind", "dimension() must say what its inverse is"},
    {"alien capability", "capabilities 0x10000000000 are none of a problem's"},
    {"no capability", "a problem must have ISOLINE_FORWARD"},
    {"two kinds of step", "either ISOLINE_STEP or ISOLINE_SOLVE"},
    {"null options", "`options` is null"},
    {"endless options", "it may have 100 options, got 1099511627776"},
    {"option outside", "the default of option 'size' must be in [0, 1], got 5"},
    {"endless components", "isoline_plugin() must return null behind the last component, got 1000"},
    {"nothing at all", "isoline_plugin() has no component"},
    {"no inputs", "dimension() must give inputs from 1 to 134217728, got 0"},
    {"2^40 inputs", "dimension() must give inputs from 1 to 134217728, got 1099511627776"},
    {"no outputs", "dimension() must give outputs from 1 to 134217728, got 0"},
    {"2^40 outputs", "dimension() must give outputs from 1 to 134217728, got 1099511627776"},
    {"2^40 kept", "dimension() must give kept from 0 to 134217728, got 1099511627776"},
    {"no dimension", "dimension() has no answer"},
    {"no instance", "instance() has no answer"},
    {"null instance of it", "open() returned null"}};

TEST(PluginLaws, ThatAreBrokenAreToldWithTheLibraryAndWhatWasGiven) {
  for (const auto& [defect, sentence] : kLaws) {
    const std::string told = complaint(defect);
    EXPECT_NE(told.find(sentence), std::string::npos) << defect << ": " << told;
    EXPECT_TRUE(told.starts_with(kTrials + ": ")) << defect << ": " << told;
  }
  EXPECT_EQ(complaint("of no name"), "nothing");
}

// What a method returns or asks, as the message of its cell.
std::string message_of_overreach(const char* defect) {
  const Defect here(defect);
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all = run(catalog, {"square"}, {"trial-overreach"});
  return all.records.size() == 1 && all.records[0].status == Status::failed ? all.records[0].message
                                                                            : "it did not fail";
}

TEST(PluginLaws, AMethodIsRefusedWhatItDidNotDeclareWhateverItMakesOfThat) {
  EXPECT_NE(message_of_overreach("").find("jacobian"), std::string::npos)
      << message_of_overreach("");
  EXPECT_NE(message_of_overreach("gradient first").find("come after linearize()"),
            std::string::npos);
  EXPECT_NE(message_of_overreach("unknown verdict").find("got 7"), std::string::npos);
  EXPECT_NE(message_of_overreach("failed step").find("trial-overreach: step() failed"),
            std::string::npos);
}

TEST(PluginLaws, AForwardWithoutAnAnswerIsNotANumber) {
  const Defect here("no answer");
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all = run(catalog, {"trial-products"}, {"gd"});
  ASSERT_EQ(all.records.size(), 1U);
  EXPECT_EQ(all.records[0].status, Status::diverged) << all.records[0].message;
}

TEST(PluginLaws, WhatIsNoLibraryIsNamed) {
  const auto told = [](const std::string& path) {
    try {
      load_plugin(path);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(told("nowhere.so").find("nowhere.so: no such file"), std::string::npos);
  EXPECT_NE(told(kPlugins).find("is a folder"), std::string::npos) << told(kPlugins);
  EXPECT_NE(told(__FILE__).find("no library that can be loaded"), std::string::npos);
  EXPECT_NE(told(kPlugins + "/empty.so").find("it exports no isoline_plugin()"), std::string::npos);
}

}  // namespace
}  // namespace isoline::benchmarks
