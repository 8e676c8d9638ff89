// Error rates of decisions, by simulation with fixed random streams: errors of the group of the
// best at 5 %, coverage of intervals at 95 %, power at 80 %. The short version takes seconds; the
// whole tables, with their figures printed, are made by
//   ISOLINE_LONG_TESTS=1 build/release/tests/results_tests --gtest_filter='ErrorRates.*'
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/draws.h"
#include "core/json.h"
#include "core/results/contrasts.h"
#include "core/results/decisions.h"
#include "core/results/statistics.h"

namespace isoline::results {
namespace {

bool is_long() { return std::getenv("ISOLINE_LONG_TESTS") != nullptr; }

// A share of n samples whose true value is at most `most` exceeds this in one of 30,000 tables:
// four standard errors.
Real at_most(Real most, Real n) { return most + 4 * std::sqrt(most * (1 - most) / n); }

// Whether one of the first so many methods is not in the group of the best.
bool sets_apart(const FlipLevels& levels, std::size_t methods) {
  for (std::size_t s = 0; s < methods; ++s)
    if (!levels.is_in_group(s)) return true;
  return false;
}

// --- errors of the group

// log2 of costs: noise of `doublings` about a common value for the methods that tie for the best,
// about `behind` doublings more for the others; methods of odd number have the second noise.
struct Null {
  std::string name;
  std::size_t methods = 2, tied = 2, problems = 10;
  Real doublings = 0.3, other_doublings = 0.3, behind = 0, unsolved = 0;
  std::size_t settings = 1;  // of each problem
  Real shift = 0;            // of methods with the second noise, at which all scores are equal
};

using Rows = std::vector<std::vector<Real>>;

// Sums of scores by problem, from a made-up data set.
Rows drawn_sums(const Null& null, Draws& random) {
  Rows sums(null.problems, std::vector<Real>(null.methods, 0));
  for (auto& row : sums)
    for (std::size_t setting = 0; setting < null.settings; ++setting) {
      std::vector<std::optional<Real>> costs;
      for (std::size_t s = 0; s < null.methods; ++s) {
        const bool is_odd = s % 2 == 1;
        const Real middle = 10 + (s < null.tied ? 0 : null.behind) + (is_odd ? null.shift : 0);
        const Real noise = is_odd ? null.other_doublings : null.doublings;
        const Real cost = std::exp2(middle + noise * random.normal());
        costs.emplace_back(random.uniform() < null.unsolved ? kNever : cost);
      }
      const auto ratios = cost_ratios(costs);
      for (std::size_t s = 0; s < row.size(); ++s) row[s] += score_of(*ratios[s], kProfileEnd);
    }
  return sums;
}

// The share of data sets of which the decision errs: a method that ties for the best is said to be
// worse than it, be it by the confidence set or by a lead of another.
Real error_of(const Null& null, std::size_t samples) {
  std::size_t errors = 0;
  for (std::size_t sample = 0; sample < samples; ++sample) {
    Draws random(sample, null.name, "null");
    errors += sets_apart(flip_levels(drawn_sums(null, random)), null.tied);
  }
  return Real(errors) / Real(samples);
}

// Scores are relative to the least cost, so methods of unequal noise differ in the mean at equal
// medians: the shift at which they do not, by bisection over one fixed stream.
Real balancing_shift(Null null) {
  Real low = -3, high = 3;
  constexpr int kHalvings = 12, kSamples = 300;
  for (int i = 0; i < kHalvings; ++i) {
    null.shift = (low + high) / 2;
    Real ahead = 0;  // of the methods with the second noise
    for (int sample = 0; sample < kSamples; ++sample) {
      Draws random(static_cast<std::uint64_t>(sample), null.name, "balance");
      for (const auto& row : drawn_sums(null, random))
        for (std::size_t s = 0; s + 1 < row.size(); s += 2) ahead += row[s + 1] - row[s];
    }
    (ahead > 0 ? low : high) = null.shift;
  }
  return (low + high) / 2;
}

std::vector<Null> nulls() {
  std::vector<Null> all;
  const std::vector<std::size_t> many =
      is_long() ? std::vector<std::size_t>{2, 5, 10, 40} : std::vector<std::size_t>{2, 5, 10};
  for (const std::size_t problems : {10U, 17U})
    for (const Real noise : {0.3, 1.5}) {
      for (const std::size_t k : many)
        all.push_back({"exchangeable", k, k, problems, noise, noise});
      if (is_long() || problems == 10)
        all.push_back(
            {"3 tied, 37 worse by 2 deviations", 40, 3, problems, noise, noise, 2 * noise});
      if (!is_long()) continue;
      all.push_back({"3 tied, 37 far worse", 40, 3, problems, noise, noise, 5});
      all.push_back({"2 tied, 38 worse by 2 deviations", 40, 2, problems, noise, noise, 2 * noise});
    }
  for (const std::size_t problems : {10U, 17U})
    for (const std::size_t k : many) {
      Null unequal{"unequal variances", k, k, problems, 0.3, 1.5};
      unequal.shift = balancing_shift(unequal);
      all.push_back(unequal);
      if (is_long()) all.push_back({"a fifth unsolved", k, k, problems, 1.5, 1.5, 0, 0.2});
    }
  all.push_back({"two settings a problem", 10, 10, 10, 1.5, 1.5, 0, 0, 2});
  return all;
}

TEST(ErrorRates, NoBestMethodIsSaidToBeWorseInMoreThanOneDataSetOfTwenty) {
  for (const Null& null : nulls()) {
    const bool is_costly = null.problems > 10 && null.methods > 10;  // 2¹⁶ flips of 780 pairs
    const std::size_t samples = is_long()            ? (is_costly ? 1000 : 4000)
                                : null.problems > 10 ? 40
                                                     : 200;
    const Real error = error_of(null, samples);
    EXPECT_LE(error, at_most(0.05, Real(samples))) << null.name << ", " << null.methods;
    if (!is_long()) continue;
    std::printf("%-34s k = %2zu, n = %2zu, %.1f and %.1f doublings: %.4f of %zu\n",
                null.name.c_str(), null.methods, null.problems, null.doublings,
                null.other_doublings, error, samples);
    EXPECT_LE(error, is_costly ? at_most(0.05, Real(samples)) : 0.065)
        << null.name << ", " << null.methods;
  }
}

// --- labels of real results, permuted

// The median work to 1e-6 of loss of every method that was run on these problems, from the baseline
// of the suite quick: [problem][method].
Costs quick_costs(std::size_t most_problems) {
  const Json baseline = read_json(ISOLINE_SOURCE_DIR "/benchmarks/baselines/quick.json");
  constexpr std::size_t kTightest = 2;
  std::map<std::string, std::map<std::string, std::vector<Real>>> runs;
  for (const Json& cell : baseline.at("cells")) {
    const auto name_of = [&](std::size_t which) {
      const Json& given = baseline["given"][cell.at("given")[which].get<std::size_t>()];
      return given.at(which == 0 ? "spec" : "name").get<std::string>();
    };
    if (cell.contains("work") && !cell["work"].is_null())
      runs[name_of(0)][name_of(1)].push_back(real_of(cell["work"].at(kTightest)));
  }
  // Larger grids were run with some methods only.
  std::erase_if(runs, [](const auto& row) { return row.second.size() < 30; });
  while (runs.size() > most_problems) runs.erase(std::prev(runs.end()));
  Costs costs(runs.size());
  for (const auto& [method, ignored] : runs.begin()->second) {
    const auto is_run = [&](const auto& row) { return row.second.contains(method); };
    if (!std::ranges::all_of(runs, is_run)) continue;
    std::size_t p = 0;
    for (const auto& row : runs) costs[p++].emplace_back(median_of(row.second.at(method)));
  }
  return costs;
}

// Whatever the costs of a problem are, which method has which is drawn: none is better than
// another.
TEST(ErrorRates, PermutedLabelsOfRealResultsSetNoMethodApart) {
  const Costs costs = quick_costs(is_long() ? 100 : 10);
  ASSERT_GE(costs.size(), 10U);
  ASSERT_GE(costs[0].size(), 20U);
  const std::size_t samples = is_long() ? 400 : 300;
  std::size_t errors = 0;
  for (std::size_t sample = 0; sample < samples; ++sample) {
    Draws random(sample, "quick", "labels");
    Rows sums;
    for (const auto& row : costs) {
      sums.emplace_back();
      for (const auto& ratio : cost_ratios(row))
        sums.back().push_back(score_of(*ratio, kProfileEnd));
      for (std::size_t s = sums.back().size(); s > 1; --s)
        std::swap(sums.back()[s - 1],
                  sums.back()[static_cast<std::size_t>(random.uniform() * Real(s))]);
    }
    errors += sets_apart(flip_levels(sums), sums[0].size());
  }
  const Real error = Real(errors) / Real(samples);
  EXPECT_LE(error, at_most(0.05, Real(samples)));
  if (is_long())
    std::printf("labels of quick permuted: k = %zu, n = %zu: %.4f of %zu\n", costs[0].size(),
                costs.size(), error, samples);
}

// --- coverage of intervals of scores

// A score on one setting of a family with effect `family`.
Real drawn_score(int kind, Real family, Draws& random) {
  const auto rank_of = [](Real z) { return std::erfc(-z / std::sqrt(2.0)) / 2; };
  const Real z = 0.6 * family + 0.8 * random.normal(), own = random.normal();
  switch (kind) {
    case 0:
      return std::clamp(0.5 + 0.25 * z, 0.0, 1.0);  // in the middle
    case 1:
      return std::clamp(1.05 - 0.225 * std::abs(z), 0.0, 1.0);  // first or nearly so
    case 2:
      return rank_of(z) < 0.3 ? 0 : std::clamp(0.75 + 0.2 * own, 0.0, 1.0);  // some unsolved
    case 3:
      return rank_of(z) < 0.75 ? 0 : std::clamp(0.6 + 0.25 * own, 0.0, 1.0);  // most unsolved
    case 4:
      return std::max(0.0, 1 - std::exp(0.8 * z - 1.2));  // a long tail
    case 6:
    case 7: {  // the median of 10 or 3 instances, each with 3 starts
      const std::array<Real, 3> starts{random.normal(), random.normal(), random.normal()};
      std::vector<Real> doublings;
      for (int instance = kind == 6 ? 10 : 3; instance > 0; --instance)
        for (const Real effect = random.normal(); const Real start : starts)
          doublings.push_back(2 + 1.5 * family + effect + 0.7 * start + 0.3 * random.normal());
      return score_of(std::exp2(std::max(0.0, median_of(doublings))), kProfileEnd);
    }
    default:
      return rank_of(z) < 0.12 ? 0 : std::clamp(0.97 + 0.05 * own, 0.0, 1.0);  // seldom not
  }
}

TEST(ErrorRates, IntervalsOfScoresCoverTheirStatedShare) {
  const int samples = is_long() ? 10000 : 1500;
  for (int kind = 0; kind < 8; ++kind) {
    Real truth = 0;
    constexpr int kTruth = 200000;
    Draws random(1, "score " + std::to_string(kind), "truth");
    for (int i = 0; i < kTruth; ++i) truth += drawn_score(kind, random.normal(), random) / kTruth;
    for (const std::size_t families : {6U, 8U, 10U, 13U, 17U})
      for (const std::size_t settings : {1U, 2U}) {
        int covered = 0;
        Real width = 0;
        for (int sample = 0; sample < samples; ++sample) {
          random.restart(static_cast<std::uint64_t>(sample) + 1);
          std::vector<Real> scores(families, 0);
          for (Real& score : scores) {
            const Real family = random.normal();
            for (std::size_t i = 0; i < settings; ++i)
              score += drawn_score(kind, family, random) / Real(settings);
          }
          const Interval interval = score_interval(scores);
          covered += interval.low <= truth && truth <= interval.high;
          width += (interval.high - interval.low) / samples;
        }
        const Real share = Real(covered) / samples;
        EXPECT_GE(share, 1 - at_most(0.05, samples)) << kind << ", " << families << " families";
        if (is_long())
          std::printf("score %.2f, %2zu families of %zu: covers %.3f, width %.2f\n", truth,
                      families, settings, share, width);
      }
  }
}

// Five values of one source, and a sixth: on the scale on which they are normal.
TEST(ErrorRates, PredictionIntervalsHoldTheNextValue) {
  const int samples = is_long() ? 100000 : 4000;
  for (const std::size_t n : {2U, 3U, 6U, 10U}) {
    int held = 0;
    for (int sample = 0; sample < samples; ++sample) {
      Draws random(static_cast<std::uint64_t>(sample), "prediction", "normal");
      std::vector<Real> values;
      for (std::size_t i = 0; i < n; ++i) values.push_back(random.normal());
      const Interval interval = prediction_interval(values);
      const Real next = random.normal();
      held += interval.low <= next && next <= interval.high;
    }
    const Real share = Real(held) / samples, error = 4 * std::sqrt(0.05 * 0.95 / samples);
    EXPECT_NEAR(share, 0.95, error) << n;
    if (is_long()) std::printf("prediction from %zu: %.4f\n", n, share);
  }
}

// --- power

// Differences of mean 0 and variance 1.
Real drawn_difference(int kind, Draws& random) {
  switch (kind) {
    case 0:
      return random.normal();
    case 1:
      return -std::log(1 - random.uniform()) - 1;  // one long tail
    case 2:
      return random.uniform() < 0.5 ? 0 : std::sqrt(2.0) * random.normal();  // half alike
    default:
      return random.normal() * (random.uniform() < 0.1 ? std::sqrt(5.0) : std::sqrt(5 / 9.0));
  }
}

// A second sample whose mean is what the first calls detectable.
TEST(ErrorRates, WhatIsCalledDetectableIsFoundInFourFifthsOfSamples) {
  const int samples = is_long() ? 4000 : 400;
  for (const std::size_t n : {7U, 8U, 10U, 13U, 17U})
    for (int kind = 0; kind < 4; ++kind) {
      if (!is_long() && n > 10) continue;
      int found = 0;
      for (int sample = 0; sample < samples; ++sample) {
        Draws random(static_cast<std::uint64_t>(sample), "power", std::to_string(kind), n);
        std::vector<Real> first;
        Rows second;
        for (std::size_t i = 0; i < n; ++i) first.push_back(drawn_difference(kind, random));
        const Real mean = detectable_mean(deviation_of(first), n);
        for (std::size_t i = 0; i < n; ++i)
          second.push_back({drawn_difference(kind, random) + mean, 0});
        found += flip_levels(second).pairs[0][1] <= kSignificant;
      }
      const Real share = Real(found) / samples;
      if (is_long()) std::printf("power, n = %zu, kind %d: %.3f\n", n, kind, share);
      // Tails differ: 0.75 to 0.91 at n = 7 to 17, against 0.56 to 0.79 without the correction.
      EXPECT_GE(share, 0.75 - 4 * 0.4 / std::sqrt(samples)) << n << ", " << kind;
      EXPECT_LE(share, 0.92 + 4 * 0.27 / std::sqrt(samples)) << n << ", " << kind;
    }
}

// --- contrasts that were named beforehand

// Differences of scores of mean 0: symmetric, or a method that fails on a share of the problems and
// is ahead on the others.
Real drawn_null(Real failing, Draws& random) {
  if (failing == 0) return std::clamp(0.25 * random.normal(), -1.0, 1.0);
  constexpr Real kLost = 0.9, kNoise = 0.02;
  const Real mean = random.uniform() < failing ? -kLost : failing / (1 - failing) * kLost;
  return mean + kNoise * random.normal();
}

TEST(ErrorRates, AContrastFindsADifferenceOfMeanZeroInAtMostSixOfAHundredDataSets) {
  const std::size_t samples = is_long() ? 20000 : 1500;
  for (const Real failing : {0.0, 0.1, 0.25})
    for (const std::size_t families : {7U, 12U, 16U, 24U}) {
      std::size_t found = 0;
      for (std::size_t sample = 0; sample < samples; ++sample) {
        Draws random(sample, "contrast", std::to_string(failing), families);
        std::vector<Real> differences;
        for (std::size_t g = 0; g < families; ++g)
          differences.push_back(drawn_null(failing, random));
        const Outcome outcome = contrast_of(differences).outcome;
        found += outcome == Outcome::better || outcome == Outcome::worse;
      }
      const Real share = Real(found) / Real(samples);
      EXPECT_LE(share, 0.06) << failing << ", " << families << " families";
      if (is_long())
        std::printf("contrast, %.0f %% fail, n = %zu: %.4f\n", 100 * failing, families, share);
    }
}

// Expected by an independent simulation of the same interval: 98, 46, 87, 94 and 34 in a hundred.
TEST(ErrorRates, AContrastFindsKnownFactorsOfWorkAsOftenAsStated) {
  for (const auto& [families, factor, power] : {std::tuple{12U, 8.0, 0.98},
                                                {12U, 4.0, 0.46},
                                                {16U, 4.0, 0.87},
                                                {24U, 3.0, 0.94},
                                                {24U, 2.0, 0.34}})
    EXPECT_NEAR(contrast_power(factor, families), power, 0.05) << families << ", " << factor;
  EXPECT_LT(contrast_power(8, 7), 0.2);
  EXPECT_EQ(detectable_factor(16), 4);
}

// A thousand solves against 1,001 are no lead, however often they repeat.
TEST(Contrasts, WithinTenPercentOfWorkAreEqualOrUndecided) {
  const Real least = std::log2(1.001) / 6;
  EXPECT_EQ(contrast_of(std::vector<Real>(16, least)).outcome, Outcome::undecided);
  EXPECT_EQ(contrast_of(std::vector<Real>(20000, least)).outcome, Outcome::equal);
  EXPECT_EQ(contrast_of(std::vector<Real>(16, 0.5)).outcome, Outcome::better);
  EXPECT_EQ(contrast_of(std::vector<Real>(12, 1)).interval.high, 1) << "no score is above 1";
  EXPECT_EQ(contrast_of(std::vector<Real>(16, -0.5)).outcome, Outcome::worse);
}

// By hand, n = 2 + 2: mean 0.25, s = √((2·0.25² + 1.25² + 0.75²)/3) = 0.86603, t(3) = 3.18245.
TEST(Contrasts, AreTIntervalsWithTwoPseudoFamilies) {
  const Contrast two = contrast_of({0.5, 0.5});
  EXPECT_NEAR(two.mean, 0.25, 1e-12);
  EXPECT_NEAR(two.interval.low - two.mean, -1.25, 1e-12) << "half is 1.378, but no score below −1";
  const Contrast many = contrast_of(std::vector<Real>(8, 0.5));  // s = √((8·0.01 + 1.96 + 0.36)/9)
  EXPECT_NEAR(many.interval.high - many.mean, 2.26216 * 0.51640 / std::sqrt(10.0), 1e-4);
}

TEST(Contrasts, AreTestedUntilOneFails) {
  const std::vector<Real> clear(16, 0.5), none(16, 0);
  const std::vector<Contrast> all = contrasts_in_order({clear, none, clear});
  EXPECT_TRUE(all[0].is_tested);
  EXPECT_TRUE(all[1].is_tested);
  EXPECT_FALSE(all[2].is_tested);
}

// Clopper, Pearson (1934): 0 of 10 has the upper bound 1 − 0.025^(1/10).
TEST(Contrasts, SharesHaveExactBounds) {
  EXPECT_EQ(exact_share(0, 10).low, 0);
  EXPECT_NEAR(exact_share(0, 10).high, 1 - std::pow(0.025, 0.1), 1e-9);  // halvings
  EXPECT_NEAR(exact_share(3, 10).low, 0.06673951, 1e-7);                 // scipy 1.10, beta.ppf
  EXPECT_NEAR(exact_share(3, 10).high, 0.65245285, 1e-7);
}

}  // namespace
}  // namespace isoline::results
