// The best losses known: who has them, who may lower them, and what follows for a run.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "benchmarks/plan/build_parts.h"
#include "benchmarks/plan/rates.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/execute.h"
#include "core/errors.h"
#include "tests/benchmarks/builtin.h"

namespace isoline::benchmarks {

using problems::Batch;
namespace {

Component problem(const std::string& text) { return complete_problem(catalog(), parse_spec(text)); }

Record record_of(const std::string& text, std::uint64_t seed, Real loss) {
  Record record;
  record.request.problem = problem(text);
  record.request.optimizer.spec = "adam";
  record.request.seed = seed;
  record.status = Status::budget;
  record.summary.best_loss = loss;
  return record;
}

TEST(Best, KeepsTheLesserOfTwoBySeedAndBySetOfOptions) {
  BestLosses best;
  EXPECT_TRUE(best.add(record_of("brown-dennis[m=10]", 0, 5)));
  EXPECT_FALSE(best.add(record_of("brown-dennis[m=10]", 0, 6)));
  EXPECT_TRUE(best.add(record_of("brown-dennis[m=10]", 0, 4)));
  EXPECT_TRUE(best.add(record_of("brown-dennis[m=11]", 0, 9)));
  EXPECT_FALSE(best.add(record_of("brown-dennis[m=10]", 1, std::nan(""))));
  EXPECT_EQ(best.find(problem("brown-dennis[m=10]"), 0), 4);
  EXPECT_EQ(best.find(problem("brown-dennis[m=11]"), 0), 9);
  EXPECT_FALSE(best.find(problem("brown-dennis[m=10]"), 1).has_value());
  const BestLosses read = BestLosses::from_json(best.to_json(), "here");
  EXPECT_EQ(read.to_json(), best.to_json());
  EXPECT_EQ(read.find(problem("brown-dennis[m=11]"), 0), 9);
}

TEST(Best, WhatIsNoTableOfThemIsAUsageError) {
  EXPECT_THROW(BestLosses::from_json({{"schema", "isoline.best/1"}}, "here"), UsageError);
  EXPECT_THROW(BestLosses::from_json({{"schema", "isoline.rates/1"}, {"rows", Json::array()}}, "x"),
               UsageError);
}

// The learned problems of `quick`: no network attains 0.
TEST(Best, AreFLOfTheProblemsThatDeclareNone) {
  for (const char* text : {"sine[mode=learn,xi=32]", "exponential[mode=learn]"})
    for (const std::uint64_t seed : {0U, 1U, 2U}) {
      const std::optional<Real> known = BestLosses::builtin().find(problem(text), seed);
      ASSERT_TRUE(known.has_value()) << text << ", seed " << seed;
      EXPECT_GT(*known, 0);
      EXPECT_EQ(make_problem(catalog(), problem(text), seed).minimum(), known);
      EXPECT_FALSE(declares_minimum(catalog(), problem(text), seed));
    }
  EXPECT_EQ(make_problem(catalog(), problem("rosenbrock"), 0).minimum(), 0);
  EXPECT_FALSE(make_problem(catalog(), problem("brown-dennis[m=10]"), 0).minimum().has_value());
}

TEST(Best, GiveRunsWithoutADeclaredMinimumHitsThatAreExact) {
  const Request request = named({.problem = problem("exponential[mode=learn]"),
                                 .optimizer = complete_optimizer(catalog(), parse_spec("sip")),
                                 .budget = {.iterations = 200, .target = 0}});
  const auto trace = std::make_unique<Trace>();
  execute(catalog(), request, *trace);
  const Record record = isoline::benchmarks::record_of(request, *trace);
  ASSERT_TRUE(record.hits.has_value());
  EXPECT_EQ(record.minimum, BestLosses::builtin().find(request.problem, 0));
  Batch validation;
  make_problem(catalog(), request.problem, 0).draw_validation(validation);
  const Real silent = 0.5 * validation.target.squaredNorm() / 1024;  // L at y = 0
  EXPECT_NEAR(*record.scale, std::min(silent, record.summary.start_loss - *record.minimum), 1e-15);
}

TEST(Best, ArePartOfTheDigestOfTheirProblem) {
  const Component learned = problem("exponential[mode=learn]");
  EXPECT_NE(BestLosses::builtin().losses_text(learned), "");
  EXPECT_NE(learned.sources, problem("exponential").sources);
  EXPECT_EQ(problem("exponential").sources, tree_sources().at("problems/exponential.cpp"));
}

}  // namespace
}  // namespace isoline::benchmarks
