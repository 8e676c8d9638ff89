// My problem: P(x) = (x1 + c x2², x2 + c x1²), y* = P(1/2, −1/2). State the formula, its
// source, and any deviation from the source.
#include "problems/dense_physics.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

struct MyProblemOptions {
  Real coupling = 0.25;
};

void fields(MyProblemOptions& o, auto& field) { field("coupling", o.coupling, between(0, 1), "c"); }

class MyProblemPhysics final : public DensePhysics {
 public:
  explicit MyProblemPhysics(Real coupling) : DensePhysics(2, 2), c_(coupling) {}
  void value(VectorRef x, VectorOut y) const override {
    y << x[0] + c_ * x[1] * x[1], x[1] + c_ * x[0] * x[0];
  }
  void derivative(VectorRef x, BatchOut J) const override {
    J << 1, 2 * c_ * x[1], 2 * c_ * x[0], 1;
  }

 private:
  Real c_;
};

// Seeds other than 0 sample another start. Other random numbers come from draw.stream("…").
ProblemParts make_my_problem(const MyProblemOptions& o, const Draw& draw) {
  auto physics = std::make_unique<MyProblemPhysics>(o.coupling);
  const Vector truth = Eigen::Vector2d(0.5, -0.5);
  Vector target(2);
  physics->value(truth, target);
  return {.physics = std::move(physics),
          .start = draw.start(Eigen::Vector2d(1, 1)),
          .target = target,
          .minimum = 0,
          .truth = truth};
}

}  // namespace

void register_my_problem(ProblemRegistry& registry) {
  registry.add(problem_entry({.name = "my-problem",
                              .title = "My problem",
                              .formula = "P(x) = (x₁ + c x₂², x₂ + c x₁²)",
                              .source = "author (year), equation"},
                             make_my_problem));
}

}  // namespace isoline::problems
