// What is shown of a sample: itself, or the curl of a velocity, against its formula.
#include "core/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

}  // namespace
}  // namespace isoline
