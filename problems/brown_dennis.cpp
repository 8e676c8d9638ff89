// Brown and Dennis' function: fᵢ = (x1 + tᵢ x2 − e^tᵢ)² + (x3 + x4 sin tᵢ − cos tᵢ)², tᵢ = i/5,
// i = 1…m. Moré, Garbow, Hillstrom (1981), problem 16. The residuals do not vanish:
// Σ fᵢ² = 85822.2… at m = 20, the only m with a published minimum.
#include <cmath>

#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

struct Options {
  Index m = 20;
};
void fields(Options& o, auto& field) { field("m", o.m, between(4, 1000), "number of residuals"); }

// p + q s − r entry by entry: an expression, not an array.
auto misfit(Real p, Real q, const Eigen::ArrayXd& s, const Eigen::ArrayXd& r) {
  return p + q * s - r;
}

class BrownDennis final : public DensePhysics {
 public:
  explicit BrownDennis(Index m)
      : DensePhysics(4, m), t_(Vector::LinSpaced(m, 1, static_cast<Real>(m)) / 5) {
    exp_t_ = t_.unaryExpr([](Real t) { return std::exp(t); });
    sin_t_ = t_.sin();
    cos_t_ = t_.cos();
  }
  void value(VectorRef x, VectorOut y) const override {
    y = misfit(x[0], x[1], t_, exp_t_).square() + misfit(x[2], x[3], sin_t_, cos_t_).square();
  }
  void derivative(VectorRef x, BatchOut J) const override {
    J.col(0) = 2 * misfit(x[0], x[1], t_, exp_t_);
    J.col(1) = J.col(0).array() * t_;
    J.col(2) = 2 * misfit(x[2], x[3], sin_t_, cos_t_);
    J.col(3) = J.col(2).array() * sin_t_;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef u, BatchOut H) const override {
    H(0, 0) = H(2, 2) = 2 * u.sum();
    H(0, 1) = H(1, 0) = 2 * (u.array() * t_).sum();
    H(1, 1) = 2 * (u.array() * t_.square()).sum();
    H(2, 3) = H(3, 2) = 2 * (u.array() * sin_t_).sum();
    H(3, 3) = 2 * (u.array() * sin_t_.square()).sum();
  }

 private:
  Eigen::ArrayXd t_, exp_t_, sin_t_, cos_t_;  // (m)
};

ProblemParts make_brown_dennis(const Options& o, const Draw& draw) {
  // By Newton's method in quadruple precision from the standard start, to ‖∇‖ = 1e-29.
  constexpr Real kMinimum = 42911.1008131781723303;  // ½ of the published 85822.2
  const Eigen::Vector4d minimizer(-11.5944399047621653826, 13.2036300512072038213,
                                  -0.403439488176859519644, 0.236778774455736299147);
  ProblemParts parts = classical(std::make_unique<BrownDennis>(o.m), Eigen::Vector4d(25, 5, -5, -1),
                                 draw, kMinimum, minimizer);
  if (o.m != 20) {
    parts.minimum.reset();
    parts.truth.reset();
    parts.x_error = nullptr;
  }
  return parts;
}

}  // namespace

void register_brown_dennis(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "brown-dennis",
       .title = "Brown and Dennis' function",
       .group = Group::classical,
       .formula = "fᵢ = (x₁ + tᵢx₂ − exp tᵢ)² + (x₃ + x₄ sin tᵢ − cos tᵢ)²,  tᵢ = i/5,  L = ½Σfᵢ²",
       .source = "Moré, Garbow, Hillstrom (1981), problem 16; Brown and Dennis (1971)",
       .note = "The residuals do not vanish. The minimum is known for m = 20 only; the truth is "
               "the minimizer."},
      make_brown_dennis));
}

}  // namespace isoline::problems
