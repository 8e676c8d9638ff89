// Statistics against an independent implementation: golden/statistics.py, in NumPy and SciPy, whose
// results are golden/statistics.json.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/results/statistics.h"
#include "core/results/tests.h"

namespace isoline::results {
namespace {

constexpr Real kRounding = 1e-12;

const Json& golden() {
  static const Json json = read_json(ISOLINE_SOURCE_DIR "/tests/results/golden/statistics.json");
  return json;
}

Costs golden_costs() {
  Costs costs;
  for (const Json& row : golden().at("costs")) {
    costs.emplace_back();
    for (const Json& cost : row) costs.back().push_back(real_of(cost));
  }
  return costs;
}

TEST(Golden, ProfilesHaveTheSharesThatNumPyCounts) {
  const Profile profile = performance_profile(golden_costs());
  const Json &factors = golden().at("factors"), &shares = golden().at("shares");
  ASSERT_EQ(profile.solvers.size(), shares.size());
  for (std::size_t s = 0; s < shares.size(); ++s)
    for (std::size_t i = 0; i < factors.size(); ++i)
      EXPECT_NEAR(profile.share(s, factors[i]), shares[s][i].get<Real>(), kRounding)
          << "solver " << s << ", factor " << factors[i];
}

// The closed form against the trapezoidal rule over 2²⁰ intervals: each of at most 12 steps of 1/12
// is off by half an interval of 2⁻²⁰ at most.
TEST(Golden, AreasAreTheIntegralsOfTheProfiles) {
  const Profile profile = performance_profile(golden_costs());
  for (std::size_t s = 0; s < profile.solvers.size(); ++s)
    EXPECT_NEAR(profile.area(s, 64), golden().at("areas")[s].get<Real>(), 1e-6) << s;
}

TEST(Golden, MeanRanksAreThoseOfSciPy) {
  const Costs costs = golden_costs();
  std::vector<Real> sum(costs[0].size(), 0);
  for (const auto& row : costs) {
    std::vector<Real> values;
    for (const auto& cost : row) values.push_back(*cost);
    const std::vector<Real> ranks = mid_ranks(values);
    for (std::size_t s = 0; s < sum.size(); ++s) sum[s] += ranks[s];
  }
  for (std::size_t s = 0; s < sum.size(); ++s)
    EXPECT_NEAR(sum[s] / Real(costs.size()), golden().at("mean_ranks")[s].get<Real>(), kRounding);
}

TEST(Golden, ExpectedRunningTimeIsThatOfGeometricRestarts) {
  std::vector<Attempt> attempts;
  for (std::size_t i = 0; i < golden().at("spent").size(); ++i)
    attempts.push_back({golden()["spent"][i], golden().at("success")[i]});
  EXPECT_NEAR(expected_running_time(attempts), golden().at("ert").get<Real>(), 1e-10);
}

}  // namespace
}  // namespace isoline::results
