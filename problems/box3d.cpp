// Box's function: fᵢ = e^(−tᵢ x1) − e^(−tᵢ x2) − x3 (e^(−tᵢ) − e^(−10 tᵢ)), tᵢ = i/10, i = 1…m.
// Moré, Garbow, Hillstrom (1981), problem 12. Zero at (1, 10, 1), at (10, 1, −1) and all along
// x1 = x2, x3 = 0.
#include <algorithm>
#include <cmath>

#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

struct Options {
  Index m = 10;
};
void fields(Options& o, auto& field) { field("m", o.m, between(3, 1000), "number of residuals"); }

// e^(−rate·t) entry by entry: an expression, not an array.
auto decay(const Eigen::ArrayXd& t, Real rate) {
  return t.unaryExpr([rate](Real ti) { return std::exp(-rate * ti); });
}

class Box3d final : public DensePhysics {
 public:
  explicit Box3d(Index m)
      : DensePhysics(3, m),
        t_(Vector::LinSpaced(m, 1, static_cast<Real>(m)) / 10),
        weight_(decay(t_, 1) - decay(t_, 10)) {}
  void value(VectorRef x, VectorOut y) const override {
    y = decay(t_, x[0]) - decay(t_, x[1]) - x[2] * weight_;
  }
  void derivative(VectorRef x, BatchOut J) const override {
    J.col(0) = -t_ * decay(t_, x[0]);
    J.col(1) = t_ * decay(t_, x[1]);
    J.col(2) = -weight_;
  }
  bool has_curvature() const override { return true; }
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    H(0, 0) = (u.array() * t_.square() * decay(t_, x[0])).sum();
    H(1, 1) = -(u.array() * t_.square() * decay(t_, x[1])).sum();
  }

 private:
  Eigen::ArrayXd t_, weight_;  // (m)
};

ProblemParts make_box3d(const Options& o, const Draw& draw) {
  Matrix isolated(3, 2);
  isolated << 1, 10, 10, 1, 1, -1;
  ProblemParts parts =
      classical(std::make_unique<Box3d>(o.m), Eigen::Vector3d(0, 10, 20), draw, 0, isolated);
  parts.x_error = [isolated](BatchRef x, const Batch&) {
    const Real to_line = std::hypot((x(0, 0) - x(1, 0)) / std::sqrt(2.0), x(2, 0));
    return std::min(distance_to_nearest(x, isolated), to_line);
  };
  return parts;
}

}  // namespace

void register_box3d(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "box3d",
       .title = "Box's three-dimensional function",
       .group = Group::classical,
       .formula = "fᵢ = exp(−tᵢx₁) − exp(−tᵢx₂) − x₃(exp(−tᵢ) − exp(−10tᵢ)),  tᵢ = i/10,  "
                  "L = ½Σfᵢ²",
       .source = "Moré, Garbow, Hillstrom (1981), problem 12; Box (1966)"},
      make_box3d));
}

}  // namespace isoline::problems
