// Powell's singular function: f1 = x1 + 10 x2, f2 = √5 (x3 − x4), f3 = (x2 − 2 x3)²,
// f4 = √10 (x1 − x4)². The Jacobian is singular at the solution 0. Moré, Garbow, Hillstrom (1981),
// problem 13.
#include <cmath>
#include <limits>

#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

const Real kRoot5 = std::sqrt(5.0), kRoot10 = std::sqrt(10.0);

class PowellSingular final : public DensePhysics {
 public:
  PowellSingular() : DensePhysics(4, 4) {}
  void value(VectorRef x, VectorOut y) const override {
    const Real p = x[1] - 2 * x[2], q = x[0] - x[3];
    y << x[0] + 10 * x[1], kRoot5 * (x[2] - x[3]), p * p, kRoot10 * q * q;
  }
  void derivative(VectorRef x, BatchOut J) const override {
    const Real dp = 2 * (x[1] - 2 * x[2]), dq = 2 * kRoot10 * (x[0] - x[3]);
    J << 1, 10, 0, 0,           //
        0, 0, kRoot5, -kRoot5,  //
        0, dp, -2 * dp, 0,      //
        dq, 0, 0, -dq;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef u, BatchOut H) const override {
    const Real p = 2 * u[2], q = 2 * kRoot10 * u[3];
    H << q, 0, 0, -q,         //
        0, p, -2 * p, 0,      //
        0, -2 * p, 4 * p, 0,  //
        -q, 0, 0, q;
  }

  // Linear once the signs of p = x2 − 2 x3 and q = x1 − x4 are chosen: of the four, the nearest.
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef x0, VectorOut x) const override {
    const Vector guess = x0;
    x = guess;
    if (!(y[2] >= 0 && y[3] >= 0)) return false;
    Real nearest = std::numeric_limits<Real>::infinity();
    for (const Real p : {-std::sqrt(y[2]), std::sqrt(y[2])}) {
      for (const Real q : {-std::sqrt(y[3] / kRoot10), std::sqrt(y[3] / kRoot10)}) {
        const Vector candidate = solve(y[0], y[1] / kRoot5, p, q);
        const Real distance = (candidate - guess).norm();
        if (distance < nearest) x = candidate;
        nearest = std::min(nearest, distance);
      }
    }
    return true;
  }

 private:
  // x with x1 + 10 x2 = a, x3 − x4 = d, x2 − 2 x3 = p, x1 − x4 = q
  static Vector solve(Real a, Real d, Real p, Real q) {
    const Real x1 = (a - 10 * p + 20 * (q - d)) / 21, x4 = x1 - q, x3 = x4 + d;
    return Eigen::Vector4d(x1, p + 2 * x3, x3, x4);
  }
};

ProblemParts make_powell_singular(const NoOptions&, const Draw& draw) {
  return classical(std::make_unique<PowellSingular>(), Eigen::Vector4d(3, -1, 0, 1), draw, 0,
                   Vector::Zero(4));
}

}  // namespace

void register_powell_singular(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "powell-singular",
       .title = "Powell's singular function",
       .group = Group::classical,
       .formula = "f = (x₁ + 10x₂, √5(x₃ − x₄), (x₂ − 2x₃)², √10(x₁ − x₄)²),  L = ½Σfᵢ²",
       .source = "Moré, Garbow, Hillstrom (1981), problem 13; Powell (1962)"},
      make_powell_singular));
}

}  // namespace isoline::problems
