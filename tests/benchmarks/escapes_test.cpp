// Runs that lose their way: what starts far out or runs off to infinity is never called solved,
// however much it has descended.
#include <gtest/gtest.h>

#include <cmath>

#include "benchmarks/run/execute.h"
#include "problems/dense_physics.h"

namespace isoline::benchmarks {

using optimizers::Linearization;
using optimizers::stepper_entry;
using problems::DensePhysics;
using problems::problem_entry;
using problems::ProblemParts;
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();

// Goes where it is told, at once, and stays; it may ask what the loss is there.
struct Jump {
  Real to = 0;
  bool asks = true;
  struct State {
    Linearization at;
  };
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    theta.setConstant(to);
    if (asks) f.linearize(theta, s.at);
    return Status::converged;
  }
};
void fields(Jump& o, auto& field) {
  field("to", o.to, any(), "each component of θ");
  field("asks", o.asks, "whether it asks for the loss there");
}

// y = eˣ − c, one number, against y* = 0: with c = 0.35 the least of ½y² is 0 at log c.
class Cliff final : public DensePhysics {
 public:
  Cliff() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y[0] = std::exp(x[0]) - 0.35; }
  void derivative(VectorRef x, BatchOut J) const override { J(0, 0) = std::exp(x[0]); }
};

// A start that a draw has thrown to 123, where ½y² = 1e106; the standard one is 0.
ProblemParts make_cliff(const NoOptions&, const Draw&) {
  return {.physics = std::make_unique<Cliff>(),
          .start = {Vector::Constant(1, 123), Vector::Zero(1)},
          .target = Vector::Zero(1),
          .minimum = 0};
}

// y = (1, x)/(1 + x²) fades at infinity: what is left there is the loss of no model at all, three
// times the least one, as MGH09 of NIST has it from its own first start.
class Plateau final : public DensePhysics {
 public:
  Plateau() : DensePhysics(1, 2) {}
  void value(VectorRef x, VectorOut y) const override {
    y << 1 / (1 + x[0] * x[0]), x[0] / (1 + x[0] * x[0]);
  }
  void derivative(VectorRef x, BatchOut J) const override {
    const Real d = std::pow(1 + x[0] * x[0], 2);
    J << -2 * x[0] / d, (1 - x[0] * x[0]) / d;
  }
};

// At infinity f = ½·(0.3² + 0.1²) = 0.05, at the start 0.85.
ProblemParts make_plateau(const NoOptions&, const Draw&) {
  return {.physics = std::make_unique<Plateau>(),
          .start = Vector::Zero(1),
          .target = Eigen::Vector2d(-0.3, 0.1),
          .minimum = 0.05 / 3};
}

// ½y² is infinite at the start, and wherever x > 0.
class Wall final : public DensePhysics {
 public:
  Wall() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y[0] = x[0] > 0 ? kInfinity : x[0] - 1; }
  void derivative(VectorRef, BatchOut J) const override { J(0, 0) = 1; }
};
ProblemParts make_wall(const NoOptions&, const Draw&) {
  return {.physics = std::make_unique<Wall>(),
          .start = Vector::Ones(1),
          .target = Vector::Ones(1),
          .minimum = 0};
}

Catalog with_escapes() {
  Catalog catalog = builtin_catalog();
  catalog.problems.add(
      problem_entry({.name = "cliff", .title = "", .formula = "", .source = ""}, make_cliff));
  catalog.problems.add(
      problem_entry({.name = "plateau", .title = "", .formula = "", .source = ""}, make_plateau));
  catalog.problems.add(
      problem_entry({.name = "wall", .title = "", .formula = "", .source = ""}, make_wall));
  catalog.optimizers.add(stepper_entry<Jump>(
      {.name = "jump", .title = "", .formula = "", .source = "", .needs = {Oracle::forward}}));
  return catalog;
}

Record run(const std::string& problem, Real to, bool asks = true) {
  const Catalog catalog = with_escapes();
  const Request request =
      named({.problem = complete_problem(catalog, problem, OptionValues()),
             .optimizer = complete_optimizer(catalog, "jump", {{"to", to}, {"asks", asks}}),
             .budget = {.iterations = 5}});
  const auto trace = std::make_unique<Trace>();
  execute(catalog, request, *trace);
  return record_of(request, *trace);
}

std::size_t hits_of(const Record& record) {
  std::size_t met = 0;
  for (const std::int64_t iteration : record.hits->iteration) met += iteration >= 0;
  return met;
}

TEST(Escapes, OfAStartAtTenToTheHundredSixVerifyNothing) {
  const Record far = run("cliff", 100);  // from 1e106 down to 1e86
  EXPECT_GT(far.summary.start_loss, 1e105);
  EXPECT_LT(far.summary.loss, 1e-19 * far.summary.start_loss);
  EXPECT_EQ(far.verified.at("1e-1"), false);
  EXPECT_EQ(hits_of(far), 0U);
  EXPECT_NEAR(*far.scale, 0.5 * 0.65 * 0.65, 1e-15);  // ½(e⁰ − 0.35)², at the standard start
  const Record near = run("cliff", std::log(0.35));
  EXPECT_EQ(near.verified.at("1e-6"), true);
  EXPECT_EQ(near.status, Status::target);
}

TEST(Escapes, OfAMethodThatAsksNothingCostTheForwardOfTheirPoint) {
  for (const bool asks : {true, false}) {
    const Record near = run("cliff", std::log(0.35), asks);
    EXPECT_EQ(near.status, Status::target);
    EXPECT_EQ(near.summary.work, 1) << asks;
    EXPECT_EQ(near.hits->work.at(50), 1) << asks;
  }
}

TEST(Escapes, ToAPlateauOfThriceTheLeastLossVerifyNothing) {
  const Record escaped = run("plateau", 1e9);
  EXPECT_NEAR(escaped.summary.loss, 0.05, 1e-9);
  EXPECT_GT(escaped.summary.start_loss, 10 * escaped.summary.loss);
  EXPECT_EQ(*escaped.scale, *escaped.minimum);  // the data's own residual
  EXPECT_EQ(escaped.verified.at("1e-1"), false);
  EXPECT_EQ(hits_of(escaped), 0U);
}

TEST(Escapes, ALossThatIsNotFiniteIsNeitherVerifiedNorHit) {
  const Record stayed = run("wall", 2);
  EXPECT_FALSE(std::isfinite(stayed.summary.loss));
  for (const auto& [name, verified] : stayed.verified) EXPECT_EQ(verified, false) << name;
  EXPECT_EQ(hits_of(stayed), 0U);
  EXPECT_EQ(stayed.status, Status::diverged);
}

// Infinity at most infinity says nothing: neither of the loss, nor of the x that is sought.
TEST(Escapes, WithAnInfiniteScaleVerifyAndFindNothing) {
  Trace trace;
  trace.points = 1;
  trace.status = Status::converged;
  trace.minimum = 0;
  trace.last.loss = trace.last.x_error = 1;
  trace.scale = trace.x_scale = kInfinity;
  const Request request =
      named({.problem = complete_problem(with_escapes(), "wall", OptionValues()),
             .optimizer = complete_optimizer(with_escapes(), "jump", {})});
  for (const Real error : {Real{1}, kInfinity}) {
    trace.last.x_error = error;
    const Record record = record_of(request, trace);
    for (const auto& [name, verified] : record.verified) EXPECT_EQ(verified, false) << name;
    for (const auto& [name, found] : record.found) EXPECT_EQ(found, false) << name;
  }
}

}  // namespace
}  // namespace isoline::benchmarks
