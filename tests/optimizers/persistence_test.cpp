// A run stopped after a step and gone on with by a new process leaves the same iterates, bit for
// bit.
#include <gtest/gtest.h>

#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

using problems::Problem;
namespace {

// No loss is below the minimum: a method that lands on it exactly, as the sums happen to round, is
// not stopped there either.
constexpr Budget kUnreachable{.iterations = 1000, .target = -1};

struct Ongoing {
  const Problem& problem;
  const OptimizerEntry& entry;
  OptionValues options = options_of_spec(entry, entry.name);
  std::unique_ptr<Trace> trace = std::make_unique<Trace>();
  std::unique_ptr<Optimizer> method = entry.make(options, optimizers());
  Meter meter{problem, kUnreachable, needs_of(entry, options, problem), *trace};
  Vector theta = problem.start();

  void begin() {
    meter.begin(theta);
    method->start(meter, theta);
  }
  void advance(int steps) {
    for (int i = 0; i < steps && meter.status() == Status::running; ++i) {
      if (method->step(meter, theta) != Status::running) return;
      meter.iterate(theta);
    }
  }
};

constexpr int kBefore = 5, kAfter = 7;

void expect_same_after_restoring(const Problem& problem, const OptimizerEntry& entry) {
  Ongoing whole{problem, entry}, first{problem, entry}, second{problem, entry};
  whole.begin();
  whole.advance(kBefore + kAfter);
  first.begin();
  first.advance(kBefore);
  Archive written;
  EXPECT_TRUE(first.method->persist(written)) << entry.name << " would start anew";
  first.meter.persist(written);
  Archive read(written.bytes());
  second.theta = first.theta;
  second.method->start(second.meter, second.theta);
  second.method->persist(read);
  second.meter.persist(read);
  second.advance(kAfter);
  EXPECT_EQ(second.theta, whole.theta) << entry.name;
  EXPECT_EQ(second.trace->last.loss, whole.trace->last.loss) << entry.name;
  EXPECT_EQ(second.trace->last.counts, whole.trace->last.counts) << entry.name;
  EXPECT_NE(second.theta, problem.start()) << entry.name;
}

void expect_same_for_every_method(const Problem& problem) {
  for (const auto& [name, entry] : optimizers()) {
    const OptionValues options = options_of_spec(entry, name);
    if (!why_inapplicable(entry, options, problem).empty()) continue;
    // A library keeps its loop, and with it its state: what is stopped there starts anew.
    if (entry.make(options, optimizers())->reports_iterations()) continue;
    expect_same_after_restoring(problem, entry);
  }
}

TEST(Persistence, OfEveryMethod) {
  const std::string tiny = "sine[mode=learn,xi=3,network=mlp[layers=5-4],batch=6";
  for (const auto& [batch, data] : {std::pair{5, 0}, {5, 5}, {2, 2}})  // the last with a wide J
    expect_same_for_every_method(learned_affine(batch, data));
  for (const std::string& spec :
       {tiny + "]", tiny + ",data=6]", std::string("broyden-tridiagonal")})
    expect_same_for_every_method(published(spec));
}

TEST(Persistence, OfKroneckerFactorsOfConvolutions) {
  expect_same_after_restoring(
      published("poisson[mode=learn,N=4,batch=2,network=unet[levels=2,filters=3]]"),
      optimizers().at("kfac"));
}

}  // namespace
}  // namespace isoline::optimizers
