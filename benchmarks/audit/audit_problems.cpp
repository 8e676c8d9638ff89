// The audit's problems. The bent physics is P(x) = C (sinh x₁, sinh x₂ + x₁²/2) + d: curved and
// exactly invertible. Along the paths, its Hessian is positive definite and its singular values are
// near 1, so every method is applicable at its default rate.
#include "benchmarks/audit/audit_problems.h"

#include <cmath>

#include "problems/dense_physics.h"
#include "problems/learning.h"

namespace isoline::benchmarks {

using problems::Batch;
using problems::DensePhysics;
using problems::Draw;
using problems::HalfSquared;
using problems::Inverse;
using problems::Loss;
namespace {

Matrix inverse_of(const Matrix& A) {
  if (A.size() == 1) return A.cwiseInverse();
  const Real determinant = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
  Matrix inverse(2, 2);
  inverse << A(1, 1), -A(0, 1), -A(1, 0), A(0, 0);
  inverse /= determinant;
  return inverse;
}

Link affine(const Matrix& A, const Vector& b) {
  return {
      .value = [=](VectorRef x) -> Vector { return A * x + b; },
      .derivative = [=](VectorRef) { return A; },
      .second = [=](VectorRef, VectorRef) -> Matrix { return Matrix::Zero(A.cols(), A.cols()); },
      .invert =
          [=, inverse = inverse_of(A)](VectorRef y, VectorRef, Eigen::Ref<Vector> x) {
            x = inverse * (y - b);
            return true;
          }};
}

// (sinh x₁, sinh x₂ + x₁²/2)
Link bend() {
  return {.value = [](VectorRef x) -> Vector {
            return Eigen::Vector2d(std::sinh(x[0]), std::sinh(x[1]) + 0.5 * x[0] * x[0]);
          },
          .derivative = [](VectorRef x) -> Matrix {
            return Eigen::Matrix2d{{std::cosh(x[0]), 0}, {x[0], std::cosh(x[1])}};
          },
          .second = [](VectorRef x, VectorRef u) -> Matrix {
            return Eigen::Matrix2d{{u[0] * std::sinh(x[0]) + u[1], 0}, {0, u[1] * std::sinh(x[1])}};
          },
          .invert =
              [](VectorRef y, VectorRef, Eigen::Ref<Vector> x) {
                x[0] = std::asinh(y[0]);
                x[1] = std::asinh(y[1] - 0.5 * x[0] * x[0]);
                return true;
              }};
}

// (x₁, x₂²)
Link fold() {
  return {.value = [](VectorRef x) -> Vector { return Eigen::Vector2d(x[0], x[1] * x[1]); },
          .derivative = [](VectorRef x) -> Matrix {
            return Eigen::Matrix2d{{1, 0}, {0, 2 * x[1]}};
          },
          .second = [](VectorRef, VectorRef u) -> Matrix {
            return Eigen::Matrix2d{{0, 0}, {0, 2 * u[1]}};
          },
          .invert =
              [](VectorRef y, VectorRef x0, Eigen::Ref<Vector> x) {
                x << y[0], std::copysign(std::sqrt(y[1]), x0[1]);
                return y[1] >= 0;
              }};
}

class ChainPhysics final : public DensePhysics {
 public:
  ChainPhysics(Chain links, Index size) : DensePhysics(size, size), links_(std::move(links)) {}
  void value(VectorRef x, VectorOut y) const override { y = value_of(links_, x); }
  void derivative(VectorRef x, BatchOut J) const override {
    const std::vector<Vector> at = stations(x);
    Matrix product = Matrix::Identity(inputs(), inputs());
    for (std::size_t i = 0; i < links_.size(); ++i) product = links_[i].derivative(at[i]) * product;
    J = product;
  }
  bool has_curvature() const override { return true; }
  // H = Σ over links of Jᵢᵀ Hᵢ(uᵢ) Jᵢ, Jᵢ up to the link, uᵢ pulled back to its outputs.
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    const std::vector<Vector> at = stations(x);
    Matrix sum = Matrix::Zero(inputs(), inputs());
    Vector pulled = u;
    for (std::size_t i = links_.size(); i-- > 0;) {
      const Matrix J = links_[i].derivative(at[i]);
      sum = J.transpose() * sum * J;
      sum += links_[i].second(at[i], pulled);
      pulled = (J.transpose() * pulled).eval();
    }
    H = sum;
  }
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef x0, VectorOut x) const override {
    const std::vector<Vector> at = stations(x0);
    Vector current = y;
    for (std::size_t i = links_.size(); i-- > 0;) {
      Vector before = at[i];
      if (!links_[i].invert(current, at[i], before)) return false;
      current = before;
    }
    x = current;
    return true;
  }

 private:
  std::vector<Vector> stations(VectorRef x) const {  // what each link is given
    std::vector<Vector> at{x};
    for (const auto& link : links_) at.push_back(link.value(at.back()));
    return at;
  }

  Chain links_;
};

// L = y, of one output.
class Height final : public Loss {
 public:
  Real value(BatchRef y, BatchRef) const override { return y.sum(); }
  void cotangent(BatchRef, BatchRef, BatchOut g) const override { g.setOnes(); }
  void curvature(BatchRef, BatchRef, BatchRef, BatchOut dg) const override { dg.setZero(); }
};

const Eigen::Vector2d kBentStart(1.0, 0.9), kBentSolution(0.6, 0.4);

Chain bent() {
  return {bend(), affine(Eigen::Matrix2d{{1.5, 0.5}, {-0.2, 1}}, Eigen::Vector2d(0.3, -0.7))};
}

// No minimum is declared, so that no run stops early.
Problem make(const Chain& chain, const Vector& start, const Vector& solution, Real weight = 1) {
  return Problem({.physics = std::make_unique<ChainPhysics>(chain, start.size()),
                  .start = start,
                  .target = value_of(chain, solution),
                  .loss = std::make_unique<HalfSquared>(weight),
                  .truth = solution});
}

Chain joined(Chain first, const Chain& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

Composition composition(const Chain& stage) {
  const Chain whole = joined(stage, bent());
  return {stage, make(bent(), value_of(stage, kBentStart), value_of(stage, kBentSolution)),
          make(whole, kBentStart, kBentSolution)};
}

Problem taught(Real weight, const Matrix& A, const Vector& b) {
  constexpr Index kSamples = 8;
  constexpr Real kReach = 0.3;  // around the solution of the bent problem
  const Chain chain = joined(bent(), {affine(A, b)});
  const auto sample = [chain](RandomStream& stream, Index i, Batch& batch) {
    for (const Index k : {0, 1})
      batch.truth(k, i) = kBentSolution[k] + stream.uniform(-kReach, kReach);
    batch.input.col(i) = value_of(bent(), batch.truth.col(i));
    batch.target.col(i) = value_of(chain, batch.truth.col(i));
  };
  return Problem(
      learn({.mode = "learn", .network = kTaughtNetwork, .batch = kSamples, .data = kSamples},
            {.inputs = 2, .outputs = 2}, Draw(0, "audit"),
            {.physics = std::make_unique<ChainPhysics>(chain, 2),
             .loss = std::make_unique<HalfSquared>(weight),
             .samples = {.draw = sample}}));
}

}  // namespace

Vector Change::backward(VectorRef x) const { return inverse_of(A) * (x - b); }

Change change_of(std::size_t kind) {
  const Real angle = 0.7;  // of the rotation, in radians: far from any symmetry
  switch (kind) {
    case 0:  // powers of two, which rounding does not see
      return {Eigen::Matrix2d{{1.0 / 128, 0}, {0, 32}}, Vector::Zero(2)};
    case 1:
      return {
          Eigen::Matrix2d{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}},
          Vector::Zero(2)};
    default:
      return {Eigen::Matrix2d{{2, 1.5}, {-0.4, 0.7}}, Eigen::Vector2d(0.3, -0.8)};
  }
}

Vector value_of(const Chain& chain, VectorRef x) {
  Vector value = x;
  for (const auto& link : chain) value = link.value(value);
  return value;
}

Problem bent_problem() { return scaled_loss(1); }
Problem scaled_loss(Real c) { return make(bent(), kBentStart, kBentSolution, c); }
Problem scaled_output(Real s) {
  return changed_output({s * Matrix::Identity(2, 2), Vector::Zero(2)});
}
Problem scaled_input(Real s) {
  const Link scale = affine(s * Matrix::Identity(2, 2), Vector::Zero(2));
  return make(joined({scale}, bent()), kBentStart / s, kBentSolution / s);
}

Problem slope(Real alpha) {
  const Chain chain{affine(Matrix::Constant(1, 1, alpha), Vector::Zero(1))};
  const Vector start = Vector::Ones(1);
  return Problem({.physics = std::make_unique<ChainPhysics>(chain, 1),
                  .start = start,
                  .target = Matrix::Constant(1, 1, alpha - 1),
                  .loss = std::make_unique<Height>(),
                  .truth = Matrix::Constant(1, 1, 1 - 1 / alpha)});
}

Problem changed_input(const Change& x) {
  return make(joined({affine(x.A, x.b)}, bent()), x.backward(kBentStart),
              x.backward(kBentSolution));
}

Problem changed_output(const Change& y) {
  return make(joined(bent(), {affine(y.A, y.b)}), kBentStart, kBentSolution);
}

Problem taught_loss(Real c) { return taught(c, Matrix::Identity(2, 2), Vector::Zero(2)); }
Problem taught_output(Real s) { return taught(1, s * Matrix::Identity(2, 2), Vector::Zero(2)); }
Problem taught_change(const Change& y) { return taught(1, y.A, y.b); }

Vicinity regular_vicinity() {
  return {make(bent(), kBentSolution + Eigen::Vector2d(0.1, -0.08), kBentSolution), kBentSolution};
}

Vicinity singular_vicinity() {
  const Chain chain{affine(Matrix::Identity(2, 2), -kBentSolution), fold()};
  return {make(chain, kBentSolution + Eigen::Vector2d(0.1, 0.08), kBentSolution), kBentSolution};
}

Composition linear_composition() {
  return composition({affine(Eigen::Matrix2d{{1, 0.8}, {-0.3, 0.5}}, Eigen::Vector2d(0.1, 0.2))});
}

Composition curved_composition() { return composition({bend()}); }

}  // namespace isoline::benchmarks
