// Levenberg-Marquardt by products, against its definition and against the dense method.
#include <gtest/gtest.h>

#include "core/decompose.h"
#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

using problems::Point;
using problems::Problem;
namespace {

// The first step from y, J and r formed: (JᵀJ + μ) d = −Jᵀr with μ = 10⁻⁴ ‖J g‖²/‖g‖². Conjugate
// gradients stop at a tenth, for η = 0.1 at the first point: of one unknown they are exact.
TEST(LevenbergMarquardtCg, TakesTheDampedStepToItsTolerance) {
  for (const char* spec : {"sine[xi=2]", "rosenbrock", "wood", "exponential[n=1]"}) {
    const Problem problem = published(spec);
    const Outcome outcome = run(problem, "levenberg-marquardt-cg", {.iterations = 1});
    const Vector step = outcome.theta - problem.start();
    Point at;
    problem.forward(problem.start(), at);
    Matrix J;
    problem.jacobian(J, at);
    const Vector g = J.transpose() * (at.y - problem.target()).reshaped();
    const Real mu = 1e-4 * (J * g).squaredNorm() / g.squaredNorm();
    if (outcome.trace->rejected_steps > 0) continue;
    const Vector left = J.transpose() * (J * step) + mu * step + g;
    EXPECT_LE(left.norm(), 0.1 * g.norm()) << spec;
    EXPECT_LT(step.dot(g), 0) << spec;
  }
}

TEST(LevenbergMarquardtCg, FindsWhatTheDenseMethodFinds) {
  for (const char* spec : {"rosenbrock", "beale", "helical-valley", "wood", "sine[xi=2]",
                           "broyden-tridiagonal[n=20]", "coupled-oscillators[mode=direct]"}) {
    const Problem problem = published(spec);
    const Budget budget{.iterations = 400, .target = 0};
    const Outcome dense = run(problem, "levenberg-marquardt", budget);
    const Outcome products = run(problem, "levenberg-marquardt-cg", budget);
    const Real dense_loss = dense.trace->last.loss, loss = products.trace->last.loss;
    EXPECT_LE(loss, dense_loss + 1e-12 * products.trace->start_loss) << spec;
    EXPECT_EQ(products.trace->last.counts[static_cast<std::size_t>(Oracle::jacobian)], 0) << spec;
  }
}

// Where the residual cannot vanish: the same least loss, and the same point.
TEST(LevenbergMarquardtCg, FindsTheSameMinimumWithResiduals) {
  const Problem problem = published("brown-dennis");
  const Outcome dense = run(problem, "levenberg-marquardt", {.iterations = 1000, .target = 0});
  const Outcome products =
      run(problem, "levenberg-marquardt-cg", {.iterations = 1000, .target = 0});
  EXPECT_NEAR(products.trace->last.loss, dense.trace->last.loss, 1e-9 * dense.trace->last.loss);
}

TEST(LevenbergMarquardtCg, TreatsProblemsTooLargeForAJacobian) {
  const Problem problem = published("heat[N=64]");
  const Outcome outcome = run(problem, "levenberg-marquardt-cg", {.iterations = 10});
  EXPECT_LT(outcome.trace->last.loss, 1e-6 * outcome.trace->start_loss);
}

}  // namespace
}  // namespace isoline::optimizers
