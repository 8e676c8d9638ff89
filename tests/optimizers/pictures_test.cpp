// What is kept for pictures of a run.
#include <gtest/gtest.h>

#include "core/frames.h"
#include "problems/burgers_flow.h"
#include "run.h"

namespace isoline::optimizers {
namespace {

TEST(Pictures, OfAVelocityAreItsCurl) {
  const Problem problem = published("navier-stokes[N=8]");
  const Outcome outcome = run(problem, "gd", {.iterations = 1, .target = 0});
  const Trace::Frames& frames = outcome.trace->frames;
  ASSERT_EQ(frames.rows, 8);
  ASSERT_EQ(frames.columns, 8);
  const Vector truth = curl(problem.truth()->col(0), 8, 8), start = curl(problem.start(), 8, 8);
  ASSERT_EQ(frames.iteration[0], 0);
  EXPECT_GT(truth.norm(), 0.1);
  for (Index i = 0; i < 64; ++i) {
    EXPECT_EQ(frames.truth[i], static_cast<float>(truth[i]));
    EXPECT_EQ(frames.x[0][i], static_cast<float>(start[i]));
    EXPECT_EQ(frames.target[i], static_cast<float>(problem.target()(i, 0)));
  }
}

// The states are compared with those of simulations of their own, ended where the row is.
TEST(Pictures, OfBurgersAreTheStatesFromXToY) {
  constexpr Index kN = 16, kSteps = 6;
  constexpr Real kTime = 0.3, kViscosity = 0.005;
  const Problem problem = published("burgers[N=16,steps=6,time=0.3]");
  const Outcome outcome = run(problem, "gd", {.iterations = 3, .target = 0});
  const Trace::Frames& frames = outcome.trace->frames;
  ASSERT_EQ(frames.rows, kSteps + 1);
  ASSERT_EQ(frames.columns, kN);
  ASSERT_EQ(frames.iteration[3], 3);
  const auto expect_states = [&](const float* cells, const Vector& x) {
    Vector state = x;
    for (Index t = 0; t <= kSteps; ++t) {
      if (t > 0)
        problems::BurgersFlow(kN, t, kViscosity, kTime * static_cast<Real>(t) / kSteps)
            .evolve(x, state);
      for (Index i = 0; i < kN; ++i)  // but for the rounding of Δt
        EXPECT_NEAR(cells[(kSteps + 1) * i + t], state[i], 1e-6) << t;
    }
    EXPECT_GT((state - x).norm(), 0.005) << "it moves";
  };
  expect_states(frames.truth, problem.truth()->col(0));
  expect_states(frames.x[3], outcome.theta);
  for (Index i = 0; i < kN; ++i) {
    EXPECT_EQ(frames.truth[(kSteps + 1) * i + kSteps], static_cast<float>(problem.target()(i, 0)));
    EXPECT_EQ(frames.target[(kSteps + 1) * i + kSteps], static_cast<float>(problem.target()(i, 0)));
    EXPECT_EQ(frames.target[(kSteps + 1) * i], 0) << "of y* the last row alone";
  }
}

TEST(Pictures, OfALongHistoryAreStatesAtEvenTimes) {
  const Problem problem = published("burgers[N=128,steps=1000,time=0.1]");
  ASSERT_EQ(problem.field()->rows, 65);
  const problems::BurgersFlow flow(128, 1000, 0.005, 0.1), half(128, 500, 0.005, 0.05);
  const Vector x = problem.truth()->col(0);
  Matrix states(65, 128);
  problem.history()(x, states);
  Vector state(128);
  flow.evolve(x, state);
  EXPECT_EQ(states.row(64).transpose(), state);
  EXPECT_EQ(states.row(0).transpose(), x);
  half.evolve(x, state);
  EXPECT_LT((states.row(32).transpose() - state).norm(), 1e-12);
}

TEST(Pictures, OfTheLargestBurgersHaveRoom) {
  const Field field = *published("burgers[N=4096,steps=10000,time=0.001]").field();
  EXPECT_EQ(field.rows, 4);
  EXPECT_LE(field.rows * field.columns, Trace::Frames::kCells);
}

}  // namespace
}  // namespace isoline::optimizers
