// What every optimizer must hold, over the registry.
#include <gtest/gtest.h>

#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

using problems::DensePhysics;
using problems::Problem;
namespace {

// Rates at which the easy quadratic, largest curvature 5.2, is solved well within the budget.
std::string sane(const std::string& name) {
  if (name == "gd" || name == "momentum" || name == "nesterov") return name + "[rate=0.1]";
  if (name == "adam" || name == "rmsprop") return name + "[rate=0.01]";
  if (name == "adamw") return "adamw[rate=0.01,weight-decay=0]";
  if (name == "adadelta") return "adadelta[rate=0.1]";
  if (name == "shampoo") return "shampoo[rate=0.5]";
  if (name == "adagrad") return "adagrad[rate=0.5]";
  if (name == "rescaled") return "rescaled[network-optimizer=gd[rate=1e-3]]";  // of one length
  return name;
}

std::vector<Problem> some_problems() {
  std::vector<Problem> all;
  all.push_back(easy());
  all.push_back(published("broyden-tridiagonal"));
  return all;
}

bool applies(const OptimizerEntry& entry, const Problem& problem) {
  return why_inapplicable(entry, options_of_spec(entry, entry.name), problem).empty();
}

TEST(Optimizers, SolveAnEasyQuadratic) {
  constexpr Real kTau = 1e-6;
  for (const auto& [name, entry] : optimizers()) {
    if (!applies(entry, easy())) continue;
    const Outcome result = run(easy(), sane(name), {.iterations = 20000, .target = kTau});
    EXPECT_EQ(result.status, Status::target) << name << ": " << result.trace->claimed;
    EXPECT_LE(result.trace->last.loss, kTau * result.trace->start_loss) << name;
  }
}

TEST(Optimizers, SayWhatTheyAre) {
  for (const auto& [name, entry] : optimizers()) {
    EXPECT_FALSE(entry.title.empty() || entry.formula.empty() || entry.source.empty()) << name;
    EXPECT_TRUE(entry.needs.contains(Oracle::forward)) << name;
    for (const OptionField& field : entry.options) EXPECT_FALSE(field.doc.empty()) << name;
  }
}

void expect_same_trace(const Trace& a, const Trace& b, const std::string& name) {
  ASSERT_EQ(a.points, b.points) << name;
  EXPECT_EQ(a.status, b.status) << name;
  EXPECT_STREQ(a.claimed, b.claimed) << name;
  for (int i = 0; i < a.points; ++i) {
    EXPECT_EQ(a.point[i].iteration, b.point[i].iteration) << name;
    EXPECT_EQ(a.point[i].counts, b.point[i].counts) << name;
    EXPECT_EQ(a.point[i].loss, b.point[i].loss) << name << " at " << i;
    EXPECT_EQ(a.point[i].step_norm, b.point[i].step_norm) << name << " at " << i;
  }
}

TEST(Optimizers, LeaveTheSameTraceTwice) {
  const Budget budget{.iterations = 30, .work = 3000, .target = 0};
  for (const auto& [name, entry] : optimizers())
    for (const Problem& problem : some_problems())
      if (applies(entry, problem))
        expect_same_trace(*run(problem, name, budget).trace, *run(problem, name, budget).trace,
                          name);
}

TEST(Optimizers, SpendNoMoreThanTheirWork) {
  for (const auto& [name, entry] : optimizers())
    for (const Problem& problem : some_problems()) {
      if (!applies(entry, problem)) continue;
      for (const std::int64_t work : {1, 7, 40}) {
        const Outcome result = run(problem, name, {.iterations = 1000, .work = work, .target = 0});
        EXPECT_LE(result.trace->last.work, work) << name;
      }
    }
}

// Also where a library has evaluated without finding anything better.
TEST(Optimizers, LeaveTheLedgerAsItStandsAtTheEnd) {
  const Matrix M = Eigen::Vector2d(1e3, 1e-3).asDiagonal();
  for (const auto& [name, entry] : optimizers()) {
    const Problem steep = linear(M, Eigen::Vector2d(1, 1), Eigen::Vector2d(0, 0));
    if (!applies(entry, steep)) continue;
    const Outcome result = run(steep, name, {.iterations = 5, .work = 500, .target = 0});
    const TracePoint& last = result.trace->last;
    std::int64_t work = 0;
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      work += last.counts[kind] * steep.prices()[kind];
    EXPECT_EQ(last.work, work) << name;
    EXPECT_LE(last.iteration, 5) << name;
    EXPECT_GT(last.work, 0) << name;
  }
}

OracleSet without(OracleSet needs, std::size_t kind) {
  OracleSet rest;
  for (std::size_t other = 0; other < kOracles; ++other)
    if (other != kind && needs.contains(static_cast<Oracle>(other)))
      rest.add(static_cast<Oracle>(other));
  return rest;
}

void expect_refusals(const Problem& problem, const OptimizerEntry& entry) {
  const OptionValues options = options_of_spec(entry, entry.name);
  const OracleSet needs = needs_of(entry, options, problem);
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    if (!needs.contains(static_cast<Oracle>(kind))) continue;
    const auto trace = std::make_unique<Trace>();
    Meter meter(problem, iterations(5), without(needs, kind), *trace);
    Vector theta = problem.start();
    const auto method = entry.make(options, optimizers());
    meter.begin(theta);
    method->start(meter, theta);
    EXPECT_THROW(method->step(meter, theta), std::logic_error)
        << entry.name << " without " << kOracleNames[kind];
  }
}

// Each oracle a method declares and is not given must be missed: needs name nothing in vain.
TEST(Optimizers, AreRefusedWhatTheyWereNotGranted) {
  const Problem direct = easy(), learned = learned_affine(4, 4);
  for (const Problem* problem : {&direct, &learned})
    for (const auto& [name, entry] : optimizers())
      if (applies(entry, *problem)) expect_refusals(*problem, entry);
}

// The physics is not finite away from the start: no method may crash on it or lose its result.
class Cliff final : public DensePhysics {
 public:
  Cliff() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override {
    y = x.array().log().matrix();  // nan beyond 0
  }
  void derivative(VectorRef x, BatchOut J) const override { J.diagonal() = x.cwiseInverse(); }
};

TEST(Optimizers, SurviveALossThatIsNotFinite) {
  const auto cliff = [] {
    return Problem({.physics = std::make_unique<Cliff>(),
                    .start = Eigen::Vector2d(5, 2),
                    .target = Eigen::Vector2d(-3, -2),
                    .minimum = 0});
  };
  for (const auto& [name, entry] : optimizers()) {
    const Problem problem = cliff();
    if (!applies(entry, problem)) continue;
    const Outcome result = run(problem, name, {.iterations = 200, .work = 20000, .target = 1e-6});
    EXPECT_NE(result.status, Status::running) << name;
  }
}

TEST(Libraries, WriteNothingToStandardError) {
  for (const auto& [name, entry] : optimizers()) {
    if (!entry.make(options_of_spec(entry, name), optimizers())->reports_iterations()) continue;
    testing::internal::CaptureStderr();
    run(published("broyden-tridiagonal"), name, {.iterations = 50, .work = 2000, .target = 0});
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
  }
}

}  // namespace
}  // namespace isoline::optimizers
