// The verdict on a run is the harness's own: what is verified, what was hit, and what a method
// claims beside it.
#include <cmath>
#include <map>
#include <set>

#include "core/status.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {

using optimizers::Family;
namespace {

// Problems that are solved, crawled at and never solved, with every optimizer.
const FinishedMatrix& matrix() {
  static const FinishedMatrix all(
      catalog(),
      {.name = "verdicts",
       .title = "",
       .blocks = {{.problems = {"square", "rosenbrock", "brown-dennis", "brown-dennis[m=10]",
                                "sine", "helical-valley", "broyden-tridiagonal"},
                   .optimizers = {"*"},
                   .seeds = {0, 3},
                   .budget = {.iterations = 1000, .work = 3000}}}},
      Rates::builtin());
  return all;
}

bool is_met(const Record& record, Real loss, Real tau) {
  return std::isfinite(loss) && loss <= *record.minimum + tau * *record.scale;
}

// What a run is stopped at.
bool meets_target(const Record& record) {
  const Real tau = record.request.budget.target;
  if (record.aim == Aim::loss) return is_met(record, record.summary.loss, tau);
  return record.summary.x_error <= x_goal(tau, *record.x_scale, record.x_floor);
}

TEST(Verdicts, VerifiedIsWhatTheReturnedPointMeets) {
  std::size_t met = 0, missed = 0;
  for (const Record& record : matrix().records)
    for (const auto& [name, tau] : kVerified) {
      const std::optional<bool> verified = record.verified.at(name);
      EXPECT_EQ(verified.has_value(), record.minimum.has_value()) << title_of(record);
      if (!verified) continue;
      EXPECT_EQ(*verified, is_met(record, record.summary.loss, tau)) << title_of(record) << name;
      (*verified ? met : missed) += 1;
    }
  EXPECT_GT(met, 50U);
  EXPECT_GT(missed, 20U);
}

TEST(Verdicts, TargetIsTheVerdictWhereverTheTargetIsMet) {
  for (const Record& record : matrix().records) {
    if (!record.minimum) {
      EXPECT_NE(record.status, Status::target) << title_of(record);
      continue;
    }
    if (record.status == Status::inapplicable) continue;
    EXPECT_EQ(record.status == Status::target, meets_target(record))
        << title_of(record) << " is " << name_of(record.status);
  }
}

// A loss of 1e-20 was at 2.3e-5 of x.
TEST(Verdicts, WhereXIsSoughtAMethodThatConvergesGoesOnUntilItIsFound) {
  std::size_t count = 0;
  for (const Record& record : matrix().records) {
    const std::string& method = record.request.optimizer.name;
    if (record.aim != Aim::x || record.request.seed != 0) continue;
    if (method != "newton" && method != "gauss-newton" && method != "ceres-lm") continue;
    EXPECT_EQ(record.found.at("1e-6"), true) << title_of(record);
    ++count;
  }
  EXPECT_EQ(count, 3U);
}

TEST(Verdicts, WithoutADeclaredMinimumNothingIsVerifiedAndNothingHit) {
  std::size_t count = 0;
  for (const Record& record : matrix().records) {
    EXPECT_EQ(record.hits.has_value(), record.minimum.has_value()) << title_of(record);
    count += !record.minimum.has_value();
  }
  EXPECT_GT(count, 0U);  // brown-dennis[m=10]
}

TEST(Verdicts, FoundIsWhatTheErrorInXOfTheReturnedPointMeets) {
  std::size_t met = 0, missed = 0;
  for (const Record& record : matrix().records)
    for (const auto& [name, tau] : kVerified) {
      const std::optional<bool> found = record.found.at(name);
      EXPECT_EQ(found.has_value(), record.x_scale.has_value()) << title_of(record);
      if (!found) continue;
      EXPECT_EQ(*found, record.summary.x_error <= x_goal(tau, *record.x_scale, record.x_floor))
          << title_of(record) << name;
      (*found ? met : missed) += 1;
    }
  EXPECT_GT(met, 50U);
  EXPECT_GT(missed, 20U);
}

TEST(Verdicts, NameWhatTheUserOfTheProblemWants) {
  for (const Record& record : matrix().records) {
    if (record.status == Status::inapplicable) continue;
    const Aim aim = catalog().problems.at(record.request.problem.name).aim;
    EXPECT_EQ(record.aim, aim) << title_of(record);
    EXPECT_EQ(aim, record.request.problem.name == "square" ? Aim::x : Aim::loss);
  }
}

TEST(Verdicts, TheScaleOfTheLossIsThatOfTheProblemWhateverTheDrawnStart) {
  std::map<std::string, std::set<Real>> scales;
  for (const Record& record : matrix().records)
    if (record.scale && record.request.problem.name == "rosenbrock")
      scales[record.request.problem.spec].insert(*record.scale);
  Real least = 24.2 / 2;  // ½Σf² at (−1.2, 1), published as 24.2
  for (const Real scale : scales.at("rosenbrock")) EXPECT_LE(scale, least * (1 + 1e-12));
}

// Ours say at most by which of their ways they made their steps, or why they stalled.
TEST(Verdicts, LibrariesClaimSuccessAndOurMethodsDoNot) {
  for (const Record& record : matrix().records) {
    if (record.status == Status::inapplicable) continue;
    const Family family = catalog().optimizers.at(record.request.optimizer.name).family;
    const bool is_library = family == Family::ceres || family == Family::nlopt ||
                            family == Family::nlopt_derivative_free;
    const bool is_reason =
        record.claimed.starts_with("steps by ") || record.status == Status::stalled;
    EXPECT_EQ(is_library, !record.claimed.empty() && (is_library || !is_reason))
        << title_of(record) << ": " << record.claimed;
  }
}

TEST(Hits, ComeInOrderAndNeverAgainOnceMissed) {
  for (const Record& record : matrix().records) {
    if (!record.hits) continue;
    const Hits& hits = *record.hits;
    ASSERT_EQ(hits.target.size(), 51U) << title_of(record);
    for (std::size_t j = 0; j < hits.target.size(); ++j) {
      EXPECT_NEAR(std::log10(hits.target[j]), -static_cast<Real>(j) / 5, 1e-12);  // rounding
      EXPECT_EQ(hits.iteration[j] < 0, hits.work[j] < 0) << title_of(record);
      EXPECT_EQ(hits.iteration[j] < 0, hits.forwards[j] < 0) << title_of(record);
      if (j == 0 || hits.iteration[j] < 0) continue;
      EXPECT_GE(hits.iteration[j - 1], 0) << title_of(record);
      EXPECT_GE(hits.iteration[j], hits.iteration[j - 1]) << title_of(record);
      EXPECT_GE(hits.work[j], hits.work[j - 1]) << title_of(record);
      EXPECT_GE(hits.forwards[j], hits.forwards[j - 1]) << title_of(record);
      EXPECT_GE(hits.wall_seconds[j], hits.wall_seconds[j - 1]) << title_of(record);
    }
  }
}

TEST(Hits, CountEveryOracleThatTheirWorkIsMadeOf) {
  for (const Record& record : matrix().records) {
    if (!record.hits) continue;
    for (std::size_t j = 0; j < record.hits->target.size(); ++j) {
      if (record.hits->iteration[j] < 0) continue;
      std::int64_t work = 0;
      for (std::size_t kind = 0; kind < kOracles; ++kind) {
        const auto column = record.hits->counts.find(std::string(kOracleNames[kind]));
        if (column != record.hits->counts.end()) work += record.prices[kind] * column->second[j];
      }
      EXPECT_EQ(work, record.hits->work[j]) << title_of(record) << ", target " << j;
    }
  }
}

TEST(Hits, AreMetExactlyAsFarAsTheBestLossGoes) {
  for (const Record& record : matrix().records) {
    if (!record.hits) continue;
    for (std::size_t j = 0; j < record.hits->target.size(); ++j)
      EXPECT_EQ(record.hits->iteration[j] >= 0,
                is_met(record, record.summary.best_loss, record.hits->target[j]))
          << title_of(record) << ", target " << j << ", best " << record.summary.best_loss;
  }
}

TEST(Hits, AreNoLaterThanTheCurveShowsThem) {
  for (const Record& record : matrix().records) {
    if (!record.hits) continue;
    for (std::size_t j = 0; j < record.hits->target.size(); ++j)
      for (std::size_t i = 0; i < record.curve.loss.size(); ++i) {
        if (!is_met(record, record.curve.loss[i], record.hits->target[j])) continue;
        EXPECT_GE(record.hits->iteration[j], 0) << title_of(record);
        EXPECT_LE(record.hits->iteration[j], record.curve.iteration[i]) << title_of(record);
        EXPECT_LE(record.hits->work[j], record.curve.work[i]) << title_of(record);
        break;
      }
  }
}

}  // namespace
}  // namespace isoline::benchmarks
