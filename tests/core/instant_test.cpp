// Instants are read as they are written.
#include <gtest/gtest.h>

#include "core/clock.h"

namespace isoline {
namespace {

// The seconds by `date -u -d TEXT +%s`.
TEST(Instant, IsTheUniversalTimeOfSecondsSince1970) {
  EXPECT_EQ(instant_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(instant_text(1769860800), "2026-01-31T12:00:00Z");
  EXPECT_EQ(instant_from("2026-01-31T12:00:00Z"), 1769860800);
  EXPECT_EQ(instant_from("2024-02-29T23:59:59Z"), 1709251199);
}

TEST(Instant, ComesBackFromItsText) {
  for (const std::int64_t seconds : {-1LL, 0LL, 951782400LL, 4102444799LL})
    EXPECT_EQ(instant_from(instant_text(seconds)), seconds) << instant_text(seconds);
  EXPECT_EQ(instant_from(instant_text(seconds_now())).value_or(0) / 100, seconds_now() / 100);
}

TEST(Instant, IsNothingElse) {
  for (const std::string text :
       {"", "2026-01-31", "2026-01-31T12:00:00", "2026-01-31T12:00:00Z ", "2026-02-31T12:00:00Z",
        "2026-1-31T12:00:00Z", "yesterday", "2026-01-31T25:00:00Z"})
    EXPECT_EQ(instant_from(text), std::nullopt) << text;
  EXPECT_EQ(instant_from(std::string("2026-01-31T12:00:00Z\0more", 25)), std::nullopt);
}

}  // namespace
}  // namespace isoline
