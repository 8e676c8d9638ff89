// Profile-likelihood intervals: against closed forms, at bounds, where fits fail and where they
// stay flat.
#include "core/results/profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/results/statistics.h"

namespace isoline::results {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();

// S = 2 + (x₁ − 1)²/0.04 · s² over one unknown, whose others have no effect: x₁ ± 0.2 t.
ProfiledFit fit_of(Real lower = -kInfinity, Real upper = kInfinity) {
  return {.names = {"a"},
          .best = {2, {1}},
          .deviation = {0.2},
          .lower = {lower},
          .upper = {upper},
          .is_log = {false},
          .variance = 0.5,
          .freedom = 4};
}
std::optional<Refit> parabola(std::size_t, const std::vector<Real>& x) {
  return Refit{2 + 0.5 * std::pow((x[0] - 1) / 0.2, 2), x};
}
Real half() { return 0.2 * student_quantile(0.975, 4); }

TEST(LikelihoodProfiles, OfALinearModelAreTheIntervalsByT) {
  const LikelihoodProfile profile = profile_of(fit_of(), 0, parabola);
  EXPECT_NEAR(profile.low, 1 - half(), 0.005 * half());
  EXPECT_NEAR(profile.high, 1 + half(), 0.005 * half());
  EXPECT_TRUE(profile.messages.empty());
  EXPECT_EQ(profile.value.size(), 3U) << "the first try is the end";
}

// S rises as the square of ln x₁, four times as steeply above: ends at e^±.
TEST(LikelihoodProfiles, OverALogarithmAreSkewed) {
  ProfiledFit fit = fit_of();
  fit.is_log[0] = true;
  const auto skewed = [](std::size_t, const std::vector<Real>& x) -> std::optional<Refit> {
    const Real z = std::log(x[0]) / 0.2;
    return Refit{2 + 0.5 * z * z * (z > 0 ? 4 : 1), x};
  };
  const LikelihoodProfile profile = profile_of(fit, 0, skewed);
  EXPECT_NEAR(std::log(profile.low), -half(), 0.01 * half());
  EXPECT_NEAR(std::log(profile.high), half() / 2, 0.01 * half());
}

TEST(LikelihoodProfiles, EndAtABoundAndSayThatTheyAreOneSided) {
  const LikelihoodProfile profile = profile_of(fit_of(0.9, kInfinity), 0, parabola);
  EXPECT_EQ(profile.low, 0.9);
  EXPECT_NEAR(profile.high, 1 + half(), 0.005 * half());
  ASSERT_EQ(profile.messages.size(), 1U);
  EXPECT_NE(profile.messages[0].find("one-sided"), std::string::npos);
}

TEST(LikelihoodProfiles, AreInfiniteWhereTheyStayFlat) {
  const auto flat = [](std::size_t, const std::vector<Real>& x) -> std::optional<Refit> {
    return Refit{2 + 0.5 * std::pow(std::min<Real>(x[0] - 1, 0.2) / 0.2, 2), x};
  };
  const LikelihoodProfile profile = profile_of(fit_of(), 0, flat);
  EXPECT_NEAR(profile.low, 1 - half(), 0.005 * half());
  EXPECT_EQ(profile.high, kInfinity);
  EXPECT_NE(profile.messages.at(0).find("flat"), std::string::npos);
}

TEST(LikelihoodProfiles, EndWhereTheyJumpAndSaySo) {
  const auto jumping = [](std::size_t unknown, const std::vector<Real>& x) {
    std::optional<Refit> refit = parabola(unknown, x);
    if (x[0] > 1.3) refit->sum_of_squares = 1e6;
    return refit;
  };
  const LikelihoodProfile profile = profile_of(fit_of(), 0, jumping);
  EXPECT_NEAR(profile.high, 1.3, 1e-3);
  EXPECT_LT(profile.value.size(), 25U) << "values that only bisect the jump";
  ASSERT_EQ(profile.messages.size(), 1U);
  EXPECT_NE(profile.messages[0].find("inexact"), std::string::npos);
}

TEST(LikelihoodProfiles, StopBeforeWhatFailsAndReportABetterFit) {
  const auto failing = [](std::size_t unknown, const std::vector<Real>& x) -> std::optional<Refit> {
    if (x[0] > 1.1) return std::nullopt;
    if (x[0] < 0.8) return Refit{1, x};
    return parabola(unknown, x);
  };
  const LikelihoodProfile profile = profile_of(fit_of(), 0, failing);
  EXPECT_NEAR(profile.high, 1.1, 0.005);
  EXPECT_LE(profile.high, 1.1);
  EXPECT_TRUE(std::isnan(profile.low));
  EXPECT_NE(profile.messages.at(0).find("better"), std::string::npos);
  EXPECT_NE(profile.messages.back().find("fail"), std::string::npos);
}

}  // namespace
}  // namespace isoline::results
