// The helical valley: f1 = 10 (x3 − 10 θ), f2 = 10 (ρ − 1), f3 = x3, with (ρ, 2πθ) the polar
// coordinates of (x1, x2), θ in (−¼, ¾). Moré, Garbow, Hillstrom (1981), problem 7, which leaves
// x1 = 0 undefined: here θ = ±¼ there, with the sign of x2.
#include <cmath>
#include <numbers>

#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

constexpr Real kTurn = 2 * std::numbers::pi;

class HelicalValley final : public DensePhysics {
 public:
  HelicalValley() : DensePhysics(3, 3) {}
  void value(VectorRef x, VectorOut y) const override {
    Real theta = std::atan2(x[1], x[0]) / kTurn;  // (−½, ½]
    if (x[0] < 0 && theta < 0) theta += 1;
    y << 10 * (x[2] - 10 * theta), 10 * (std::hypot(x[0], x[1]) - 1), x[2];
  }
  void derivative(VectorRef x, BatchOut J) const override {
    const Real rho = std::hypot(x[0], x[1]), c = x[0] / rho, s = x[1] / rho;
    const Real turn = 100 / (kTurn * rho);
    J << turn * s, -turn * c, 10,  //
        10 * c, 10 * s, 0,         //
        0, 0, 1;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    const Real rho = std::hypot(x[0], x[1]), c = x[0] / rho, s = x[1] / rho;
    const Real turn = -100 * u[0] / (kTurn * rho * rho), stretch = 10 * u[1] / rho;
    H(0, 0) = 2 * turn * c * s + stretch * s * s;
    H(0, 1) = H(1, 0) = turn * (s * s - c * c) - stretch * c * s;
    H(1, 1) = -2 * turn * c * s + stretch * c * c;
  }
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef x0, VectorOut x) const override {
    const Real rho = 1 + y[1] / 10, theta = (y[2] - y[0] / 10) / 10;
    x = x0;
    if (!(rho > 0 && theta >= -0.25 && theta < 0.75)) return false;
    x << rho * std::cos(kTurn * theta), rho * std::sin(kTurn * theta), y[2];
    return true;
  }
};

ProblemParts make_helical_valley(const NoOptions&, const Draw& draw) {
  return classical(std::make_unique<HelicalValley>(), Eigen::Vector3d(-1, 0, 0), draw, 0,
                   Eigen::Vector3d(1, 0, 0));
}

}  // namespace

void register_helical_valley(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "helical-valley",
       .title = "Helical valley",
       .group = Group::classical,
       .formula = "f = (10(x₃ − 10θ), 10(ρ − 1), x₃),  (x₁, x₂) = ρ(cos 2πθ, sin 2πθ),  L = ½Σfᵢ²",
       .source = "Moré, Garbow, Hillstrom (1981), problem 7; Fletcher and Powell (1963)",
       .note = "θ jumps from ¾ to −¼ across x₁ = 0 > x₂."},
      make_helical_valley));
}

}  // namespace isoline::problems
