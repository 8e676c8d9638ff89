// What is shown of a sample: itself, the curl of a velocity, against its formula, or a history.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/frames.h"

namespace isoline {
namespace {

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
