// Properties of every optimizer, over the registry.
#include <gtest/gtest.h>

#include "tests/optimizers/run.h"
#include "tests/optimizers/trial_problems.h"

namespace isoline::optimizers {
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
  all.push_back(make("broyden-tridiagonal"));
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
    run(make("broyden-tridiagonal"), name, {.iterations = 50, .work = 2000, .target = 0});
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
  }
}

// A run that stops after a step and continues in a new process has the same iterates, bit for bit.

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

void expect_same_after_restoring(const Problem& problem, const OptimizerEntry& entry,
                                 int before = kBefore, int after = kAfter) {
  Ongoing whole{problem, entry}, first{problem, entry}, second{problem, entry};
  whole.begin();
  whole.advance(before + after);
  first.begin();
  first.advance(before);
  Archive written;
  EXPECT_TRUE(first.method->persist(written)) << entry.name << " would start again";
  first.meter.persist(written);
  Archive read(written.bytes());
  second.theta = first.theta;
  second.method->start(second.meter, second.theta);
  second.method->persist(read);
  second.meter.persist(read);
  second.advance(after);
  EXPECT_EQ(second.theta, whole.theta) << entry.name;
  EXPECT_EQ(second.trace->last.loss, whole.trace->last.loss) << entry.name;
  EXPECT_EQ(second.trace->last.counts, whole.trace->last.counts) << entry.name;
  EXPECT_NE(second.theta, problem.start()) << entry.name;
}

void expect_same_for_every_method(const Problem& problem) {
  for (const auto& [name, entry] : optimizers()) {
    const OptionValues options = options_of_spec(entry, name);
    if (!why_inapplicable(entry, options, problem).empty()) continue;
    // A library owns its loop and its state: a run that stops there starts again.
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
    expect_same_for_every_method(make(spec));
}

TEST(Persistence, OfKroneckerFactorsOfConvolutions) {
  expect_same_after_restoring(
      make("poisson[mode=learn,N=4,batch=2,network=unet[levels=2,filters=3]]"),
      optimizers().at("kfac"));
}

// Four epochs of eight steps before the first iterations can be added.
TEST(Persistence, OfTheNumberOfIterationsOfARefinedSolve) {
  const Problem problem =
      make("poisson[mode=learn,N=4,batch=2,jacobi=progressive,network=mlp[layers=4]]");
  expect_same_after_restoring(problem, optimizers().at("adam"), 45, 40);
}

}  // namespace
}  // namespace isoline::optimizers
