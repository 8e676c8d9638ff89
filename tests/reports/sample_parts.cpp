// The two-dimensional losses of the sample study.
#include "tests/reports/sample_parts.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace isoline::reports {
namespace {

Landscape grid(std::array<Real, 4> window, const std::function<Real(Real, Real)>& loss) {
  constexpr int kGrid = 97;
  Landscape landscape{window, Grid(kGrid, kGrid)};
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i < kGrid; ++i)
      landscape.loss(i, j) = loss(window[0] + (window[1] - window[0]) * i / (kGrid - 1),
                                  window[2] + (window[3] - window[2]) * j / (kGrid - 1));
  return landscape;
}

}  // namespace

Surface surface(bool is_sine) {
  Surface s;
  if (is_sine)
    s.map = [](const Eigen::Vector2d& x) {
      return Eigen::Vector2d(std::sin(x[0]) + 0.4 * x[1], 1.5 * x[1] + 0.3 * std::sin(3 * x[0]));
    };
  else
    s.map = [](const Eigen::Vector2d& x) { return Eigen::Vector2d(x[0], x[1] * x[1]); };
  s.in_x = grid({-0.5, 3.5, -0.5, 3.5},
                [&](Real a, Real b) { return s.map(Eigen::Vector2d(a, b)).squaredNorm(); });
  s.in_y = grid({-1, 4, -1, 10}, [](Real a, Real b) { return a * a + b * b; });
  return s;
}

// A forward solve of some microseconds, a Jacobian dearer than declared, an inverse cheaper.
MeasuredPrices sample_prices(std::size_t problem) {
  const Real factor = 1 + 0.1 * static_cast<Real>(problem % 7);
  MeasuredPrices prices{"0123456789abcdef",
                        "Intel(R) Xeon(R) Processor @ 2.70GHz",
                        2e-6 * factor,
                        {{"forward", 1, 1, 1, 1, 31, 620}}};
  const auto add = [&](const char* oracle, std::int64_t declared, Real price) {
    prices.oracles.push_back({oracle, declared, price, 0.9 * price, 1.2 * price, 31, 620});
  };
  add("pullback", 1, 1.3 * factor);
  add("jacobian", 2, 4.1 * factor);
  add("inverse", 3, 0.7 * factor);
  return prices;
}

void descend(const Surface& s, const Kind& kind, Eigen::Vector2d& x) {
  constexpr Real kH = 1e-6;
  Eigen::Matrix2d J;
  for (int i = 0; i < 2; ++i)
    J.col(i) =
        (s.map(x + kH * Eigen::Vector2d::Unit(i)) - s.map(x - kH * Eigen::Vector2d::Unit(i))) /
        (2 * kH);
  const Eigen::Vector2d y = s.map(x), gradient = 2 * J.transpose() * y;
  const Eigen::Matrix2d H = J.transpose() * J + 1e-9 * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d newton = H.inverse() * (J.transpose() * y);
  const Real blend = std::min(1.0, kind.speed);
  x -= blend * newton * 0.8 + (1 - blend) * std::min(0.01, 0.3 / gradient.norm()) * gradient;
}

}  // namespace isoline::reports
