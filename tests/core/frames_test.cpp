// What is shown of a sample, and which x of a run are kept as pictures, whenever it ends.
#include "core/frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

namespace isoline {
namespace {

// Of a field of 2×1 cells whose x is the iteration and its negative.
class KeptFrames : public testing::Test {
 protected:
  KeptFrames() {
    const std::vector<Real> target = {1, 2}, truth = {3, 4};
    open_frames(trace->frames, 2, 1, target, truth);
  }
  void keep(std::int64_t iteration) {
    const Real value = static_cast<Real>(iteration);
    keep_frame(trace->frames, iteration, std::vector<Real>{value, -value});
  }
  std::vector<std::int64_t> chosen() const {
    std::vector<std::int64_t> iterations;
    for (const std::size_t place : chosen_frames(trace->frames)) {
      iterations.push_back(trace->frames.iteration[place]);
      EXPECT_EQ(trace->frames.x[place][0], static_cast<float>(iterations.back()));
      EXPECT_EQ(trace->frames.x[place][1], -static_cast<float>(iterations.back()));
    }
    return iterations;
  }

  std::unique_ptr<Trace> trace = std::make_unique<Trace>();
};

TEST_F(KeptFrames, OfAShortRunAreAllOfIt) {
  for (std::int64_t i = 0; i <= 5; ++i) keep(i);
  EXPECT_EQ(chosen(), (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5}));
}

// At any end, the first, the last and four within a factor of three of the even spread.
TEST_F(KeptFrames, AreSpreadAsTheLogarithmOfTheirIteration) {
  std::vector<std::int64_t> kept;
  for (std::int64_t i = 0; i < 100; ++i) kept.push_back(i);
  for (Real t = 100; t < 1e7; t *= 1.075) kept.push_back(std::llround(t));
  for (const std::int64_t iteration : kept) {
    keep(iteration);
    if (iteration < 5) continue;
    const std::vector<std::int64_t> six = chosen();
    ASSERT_EQ(six.size(), kMostFrames);
    EXPECT_EQ(six.front(), 0);
    EXPECT_EQ(six.back(), iteration);
    const Real end = static_cast<Real>(iteration) + 1;
    for (std::size_t i = 1; i + 1 < six.size(); ++i) {
      ASSERT_GT(six[i], six[i - 1]);
      const Real even = std::pow(end, static_cast<Real>(i) / (kMostFrames - 1));
      const Real ratio = (static_cast<Real>(six[i]) + 1) / even;
      EXPECT_LT(std::max(ratio, 1 / ratio), 3) << six[i] << " of " << iteration;
    }
  }
}

TEST_F(KeptFrames, OfOneIterationAreTheLastX) {
  keep(0);
  keep(1);
  keep_frame(trace->frames, 1, std::vector<Real>{7, 8});
  ASSERT_EQ(chosen_frames(trace->frames).size(), 2U);
  EXPECT_EQ(trace->frames.x[chosen_frames(trace->frames)[1]][0], 7);
}

TEST_F(KeptFrames, WithoutANumberInSinglePrecisionAreNone) {
  keep(0);
  for (const Real wrong : {std::nan(""), 1e39, -std::numeric_limits<Real>::infinity()})
    keep_frame(trace->frames, 1, std::vector<Real>{1, wrong});
  EXPECT_EQ(chosen(), std::vector<std::int64_t>{0});
}

TEST(Frames, OfAGridThatIsTooLargeAreNone) {
  for (const auto& [columns, is_kept] : {std::pair{128, true}, std::pair{129, false}}) {
    const auto trace = std::make_unique<Trace>();
    const std::vector<Real> cells(static_cast<std::size_t>(128 * columns), 1.0);
    open_frames(trace->frames, 128, columns, cells, {});
    keep_frame(trace->frames, 0, cells);
    EXPECT_EQ(chosen_frames(trace->frames).size(), is_kept ? 1U : 0U);
    EXPECT_FALSE(trace->frames.has_truth);
  }
}

TEST_F(KeptFrames, ThatCannotBeAreADefectOfTheirTrace) {
  for (std::int64_t i = 0; i < 20; ++i) keep(i);
  trace->points = 0;
  ASSERT_EQ(defect_of(*trace), "");
  const std::int64_t other = trace->frames.iteration[1];
  for (const std::int64_t wrong : {trace->frames.iteration[0], std::int64_t{-2}}) {
    trace->frames.iteration[1] = wrong;
    EXPECT_NE(defect_of(*trace), "") << wrong;
  }
  trace->frames.iteration[1] = other;
  trace->frames.columns = Trace::Frames::kCells;
  EXPECT_NE(defect_of(*trace), "");
}

// u = sin aj, v = cos bi, of which central differences have sin a and sin b for a and b.
TEST(Curl, IsThatOfAWaveOnAPeriodicGrid) {
  constexpr Index kRows = 6, kColumns = 10;
  const Real b = 2 * std::numbers::pi / kRows, a = 2 * std::numbers::pi / kColumns;
  Vector velocity(2 * kRows * kColumns);
  for (Index j = 0; j < kColumns; ++j)
    for (Index i = 0; i < kRows; ++i) {
      velocity[i + kRows * j] = std::sin(a * static_cast<Real>(j));
      velocity[kRows * kColumns + i + kRows * j] = std::cos(b * static_cast<Real>(i));
    }
  const Vector found = curl(velocity, kRows, kColumns);
  for (Index j = 0; j < kColumns; ++j)
    for (Index i = 0; i < kRows; ++i)
      EXPECT_NEAR(found[i + kRows * j],
                  -std::sin(b) * std::sin(b * static_cast<Real>(i)) -
                      std::sin(a) * std::cos(a * static_cast<Real>(j)),
                  1e-14);
}

// A state of two cells that grows by 1 a row.
TEST(PictureOfAHistory, HasAllStatesOfXAndOfYTheLastAlone) {
  const Field field{.rows = 3, .columns = 2, .time = 0.5};
  const History grow = [](VectorRef x, BatchOut states) {
    for (Index row = 0; row < states.rows(); ++row)
      states.row(row) = x.transpose().array() + static_cast<Real>(row);
  };
  Matrix batch(2, 2);
  batch << 4, 90, 7, 90;
  const auto cells = [](const Picture& picture) {
    return std::vector<Real>(picture.cells().begin(), picture.cells().end());
  };
  EXPECT_EQ(cells(Picture(batch, field, grow)), (std::vector<Real>{4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(cells(Picture(batch, field)), (std::vector<Real>{0, 0, 4, 0, 0, 7}));
  EXPECT_TRUE(cells(Picture(Matrix(), field, grow)).empty());
}

}  // namespace
}  // namespace isoline
