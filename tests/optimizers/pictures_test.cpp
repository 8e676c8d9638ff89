// What is kept for pictures of a run.
#include <gtest/gtest.h>

#include "core/picture.h"
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

}  // namespace
}  // namespace isoline::optimizers
