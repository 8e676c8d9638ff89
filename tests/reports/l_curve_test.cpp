// The corner of the L-curve, against the closed form of a linear problem in the coordinates of its
// singular value decomposition.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/results/statistics.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// min ½‖Ax − y*‖² + ½α‖x‖² with A = U Σ Vᵀ: vᵢᵀx = σᵢ βᵢ / (σᵢ² + α), where β = Uᵀ y*.
class Blur {
 public:
  static constexpr std::size_t kSize = 32;

  Blur() {
    for (std::size_t i = 0; i < kSize; ++i) {
      const auto place = static_cast<Real>(i);
      sigma_.push_back(std::pow(0.6, place));
      truth_.push_back(std::pow(0.8, place));
      const Real noise = 1e-3 * std::cos(7 * place * place);  // of no trend
      data_.push_back(sigma_[i] * truth_[i] + noise);
      level_ = std::hypot(level_, noise);
    }
  }

  Real level() const { return level_; }
  Real truth() const {
    return norm([&](std::size_t i) { return truth_[i]; });
  }
  Real discrepancy(Real alpha) const {
    return norm([&](std::size_t i) { return (1 - filter(i, alpha)) * data_[i]; });
  }
  Real size(Real alpha) const {
    return norm([&](std::size_t i) { return x(i, alpha); });
  }
  Real error(Real alpha) const {
    return norm([&](std::size_t i) { return x(i, alpha) - truth_[i]; });
  }
  // Of (log ‖Ax − y*‖, log ‖x‖) over λ = √α, by dρ/dλ = −λ² dξ/dλ for ξ = ‖x‖², ρ = ‖Ax − y*‖².
  // Hansen (1999), section 5.
  Real curvature(Real alpha) const {
    const Real l = std::sqrt(alpha), xi = std::pow(size(alpha), 2),
               rho = std::pow(discrepancy(alpha), 2);
    Real slope = 0;  // dξ/dλ
    for (std::size_t i = 0; i < kSize; ++i)
      slope -= 4 / l * (1 - filter(i, alpha)) * std::pow(x(i, alpha), 2);
    return -2 * xi * rho / slope *
           (alpha * slope * rho + 2 * l * xi * rho + alpha * alpha * xi * slope) /
           std::pow(alpha * alpha * xi * xi + rho * rho, 1.5);
  }

 private:
  template <class Component>
  static Real norm(Component component) {
    Real squared = 0;
    for (std::size_t i = 0; i < kSize; ++i) squared += std::pow(component(i), 2);
    return std::sqrt(squared);
  }
  Real filter(std::size_t i, Real alpha) const {
    return sigma_[i] * sigma_[i] / (sigma_[i] * sigma_[i] + alpha);
  }
  Real x(std::size_t i, Real alpha) const { return filter(i, alpha) * data_[i] / sigma_[i]; }

  std::vector<Real> sigma_, truth_, data_;
  Real level_ = 0;
};

Record penalized(const Blur& blur, Real alpha, const char* method, Real excess = 1) {
  Record record = record_of(
      {.problem = fmt::format("blur[noise=0.01,tikhonov={}]", alpha), .optimizer = method});
  record.request.problem.options = {{"noise", 0.01}, {"tikhonov", alpha}};
  record.cell = cell_digest(record.request);
  record.x_scale = blur.truth();
  record.noise_level = blur.level();
  const Real d = excess * blur.discrepancy(alpha);
  record.curve.discrepancy.assign(record.curve.loss.size(), d);
  record.curve.loss.back() = 0.5 * d * d + 0.5 * alpha * std::pow(blur.size(alpha), 2);
  record.curve.x_error.back() = excess * blur.error(alpha);
  return record;
}

constexpr int kSmallest = -24, kLargest = 2, kPerDecade = 3;  // α = 10^(j / kPerDecade)

std::vector<Record> sweep(const Blur& blur) {
  std::vector<Record> runs;
  for (int j = kSmallest; j <= kLargest; ++j) {
    const Real alpha = std::pow(10.0, Real(j) / kPerDecade);
    runs.push_back(penalized(blur, alpha, "a"));
    runs.push_back(penalized(blur, alpha, "b", 3));  // far from the minimum
  }
  return runs;
}

TEST(LCurve, HasItsCornerWhereTheClosedFormIsMostCurved) {
  const Blur blur;
  Real most = 0, expected = 0, least = kNever;
  for (int j = 50 * kSmallest; j <= 50 * kLargest; ++j) {
    const Real alpha = std::pow(10.0, j / (50.0 * kPerDecade)), curvature = blur.curvature(alpha);
    if (curvature > most) expected = alpha;
    most = std::max(most, curvature);
    least = std::min(least, blur.error(alpha) / blur.truth());
  }
  const Table table = l_curve_table(Compared(sweep(blur)));
  ASSERT_EQ(table.rows.size(), 1U);
  const std::vector<TableCell>& row = table.rows[0];
  EXPECT_EQ(row[0].text, "blur[noise=0.01]");
  EXPECT_EQ(row[2].text, std::to_string(kLargest - kSmallest + 1));
  const Real corner = row[3].numbers[0].second, error = row[4].numbers[0].second;
  // A step of the sweep, which has no value between.
  EXPECT_LE(std::abs(std::log10(corner / expected)), 1.0 / kPerDecade);
  EXPECT_NEAR(error, blur.error(corner) / blur.truth(), 1e-12);
  const Real at_noise = row[7].numbers[0].second;
  EXPECT_LE(blur.discrepancy(at_noise), kNoiseFactor * blur.level());
  EXPECT_GT(blur.discrepancy(at_noise * std::pow(10.0, 1.0 / kPerDecade)),
            kNoiseFactor * blur.level());
  const Real best = row[10].numbers[0].second;
  EXPECT_GE(best, least * (1 - 1e-12));
  EXPECT_LE(best, error);
}

// The corner of each other value of α is where that of all is.
TEST(LCurve, ItsCornerDoesNotMoveWithTheGridOfTheWeights) {
  const Blur blur;
  Real least = kNever, most = 0;
  for (const int step : {1, 2, 3})
    for (int first = 0; first < step; ++first) {
      std::vector<Record> runs;
      for (int j = kSmallest + first; j <= kLargest; j += step)
        runs.push_back(penalized(blur, std::pow(10.0, Real(j) / kPerDecade), "a"));
      const Real corner = l_curve_table(Compared(runs)).rows[0][3].numbers[0].second;
      least = std::min(least, corner);
      most = std::max(most, corner);
    }
  EXPECT_LE(most / least, 10.1);  // a step of the coarsest, three thirds of a decade
}

// Of the closed form d²/(Σ α/(σ² + α))², one singular value for each datum.
TEST(LCurve, HasCrossValidationWhereTheSingularValuesAreKept) {
  const Blur blur;
  std::vector<Record> runs = sweep(blur);
  Real least = kNever, expected = 0;
  for (Record& record : runs) {
    const Real alpha = record.request.problem.options.number("tikhonov", 0);
    record.spectrum = Spectrum{.iterations = {0}, .sigma = {{}}};
    Real left = 0;
    for (std::size_t i = 0; i < Blur::kSize; ++i) {
      const Real square = std::pow(0.36, Real(i)) + alpha;
      record.spectrum->sigma[0].push_back(std::sqrt(square));
      left += alpha / square;
    }
    const Real value = std::pow(blur.discrepancy(alpha) / left, 2);
    if (value < least) expected = alpha;
    least = std::min(least, value);
  }
  Study study;
  for (const Record& record : runs)
    if (study.sheets.empty() || study.sheets.back().spec != record.request.problem.spec)
      study.sheets.push_back({.kind = "problem",
                              .name = "blur",
                              .spec = record.request.problem.spec,
                              .linear = true,
                              .unknowns = Blur::kSize,
                              .residuals = 2 * Blur::kSize});
  study.runs = std::move(runs);
  const Table table = l_curve_table(Compared(std::move(study)));
  EXPECT_NEAR(table.rows[0][5].numbers[0].second / expected, 1, 1e-9);
}

TEST(LCurve, IsDrawnFromTheRunsWithTheLeastLoss) {
  const Blur blur;
  const Plots plots = l_curve_plot(Compared(sweep(blur)));
  ASSERT_EQ(plots.size(), 1U);
  ASSERT_EQ(plots[0].series.size(), 2U);
  const PlotSeries &corner = plots[0].series[0], &line = plots[0].series[1];
  ASSERT_EQ(line.x.size(), static_cast<std::size_t>(kLargest - kSmallest + 1));
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    const Real alpha = std::pow(10.0, Real(kLargest - static_cast<int>(i)) / kPerDecade);
    EXPECT_NEAR(line.x[i] / blur.discrepancy(alpha), 1, 1e-12);
    EXPECT_NEAR(line.y[i] / blur.size(alpha), 1, 1e-6);  // a difference of two losses
  }
  EXPECT_EQ(corner.x.size(), 1U);
}

TEST(LCurve, RequiresFiveValuesAndAKnownNoise) {
  const Blur blur;
  std::vector<Record> runs;
  for (const Real alpha : {1e-1, 1e-2, 1e-3, 1e-4}) runs.push_back(penalized(blur, alpha, "a"));
  EXPECT_TRUE(l_curve_table(Compared(runs)).id.empty());
  EXPECT_TRUE(l_curve_plot(Compared(runs)).empty());
  runs.push_back(penalized(blur, 1e-5, "a"));
  EXPECT_FALSE(l_curve_table(Compared(runs)).id.empty());
  for (Record& record : runs) record.curve.discrepancy.clear();
  EXPECT_TRUE(l_curve_table(Compared(runs)).id.empty());
}

}  // namespace
}  // namespace isoline::reports
