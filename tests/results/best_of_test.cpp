// The best of b values: by hand, and by counting all subsets.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "core/results/statistics.h"

namespace isoline::results {
namespace {

// Of {0, 0, 1} one value is 1 in a third of the draws, one of two in two thirds.
TEST(BestOf, IsTheExpectationOverAllSubsets) {
  const std::vector<Real> few = expected_best({0, 1, 0});
  ASSERT_EQ(few.size(), 3U);
  EXPECT_NEAR(few[0], 1.0 / 3, 1e-15);
  EXPECT_NEAR(few[1], 2.0 / 3, 1e-15);
  EXPECT_NEAR(few[2], 1, 1e-15);
  const std::vector<Real> values = {3, -1, 4, 1, -5, 9, 2};
  const std::vector<Real> best = expected_best(values);
  for (std::size_t b = 1; b <= values.size(); ++b) {
    Real sum = 0, count = 0;
    for (unsigned subset = 1; subset < 1U << values.size(); ++subset) {
      if (std::popcount(subset) != static_cast<int>(b)) continue;
      Real greatest = -std::numeric_limits<Real>::infinity();
      for (std::size_t i = 0; i < values.size(); ++i)
        if ((subset >> i & 1U) != 0) greatest = std::max(greatest, values[i]);
      sum += greatest;
      count += 1;
    }
    EXPECT_NEAR(best[b - 1], sum / count, 1e-13) << b;
  }
}

TEST(BestOf, OfNothingIsNothing) { EXPECT_TRUE(expected_best({}).empty()); }

}  // namespace
}  // namespace isoline::results
