// Broyden's tridiagonal function: fᵢ = (3 − 2 xᵢ) xᵢ − xᵢ₋₁ − 2 xᵢ₊₁ + 1, x₀ = xₙ₊₁ = 0. Moré,
// Garbow, Hillstrom (1981), problem 30. Products are O(n).

#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

struct Options {
  Index n = 10;
};
void fields(Options& o, auto& field) { field("n", o.n, between(2, 1e6), "number of unknowns"); }

class BroydenTridiagonal final : public Physics {
 public:
  explicit BroydenTridiagonal(Index n) : n_(n) {}
  Index inputs() const override { return n_; }
  Index outputs() const override { return n_; }

  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override {
    y.array() = (3 - 2 * x.array()) * x.array() + 1;
    add_neighbours(x, -1, -2, y);
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Jv.array() = (3 - 4 * w.x.array()) * v.array();
    add_neighbours(v, -1, -2, Jv);
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    JTu.array() = (3 - 4 * w.x.array()) * u.array();
    add_neighbours(u, -2, -1, JTu);
  }
  bool has_curvature() const override { return true; }
  void curvature(BatchRef u, BatchOut out, Workspace&) const override {
    out.setZero();
    for (Index b = 0; b < u.cols(); ++b) out.middleCols(b * n_, n_).diagonal() = -4 * u.col(b);
  }

 private:
  void add_neighbours(BatchRef v, Real lower, Real upper, BatchOut out) const {
    out.bottomRows(n_ - 1) += lower * v.topRows(n_ - 1);
    out.topRows(n_ - 1) += upper * v.bottomRows(n_ - 1);
  }
  Index n_;
};

// Δ with J Δ = f by elimination without pivoting: J is diagonally dominant where all xᵢ < 0, as
// they are from the standard start to the root.
Vector newton_step(VectorRef x, Vector f) {
  const Index n = x.size();
  Vector diagonal = 3 - 4 * x.array();
  for (Index i = 1; i < n; ++i) {
    diagonal[i] -= 2 / diagonal[i - 1];  // (−1)(−2) over the pivot
    f[i] += f[i - 1] / diagonal[i - 1];
  }
  f[n - 1] /= diagonal[n - 1];
  for (Index i = n - 1; i-- > 0;) f[i] = (f[i] + 2 * f[i + 1]) / diagonal[i];
  return f;
}

// The root that Newton's method finds from the standard start: quadratic, so to rounding in 10.
Vector root(const BroydenTridiagonal& P) {
  constexpr int kSteps = 10;
  Vector x = Vector::Constant(P.inputs(), -1), f(P.inputs());
  Workspace w;
  for (int step = 0; step < kSteps; ++step) {
    P.forward(x, Matrix(), f, w);
    x -= newton_step(x, f);
  }
  return x;
}

ProblemParts make_broyden_tridiagonal(const Options& o, const Draw& draw) {
  auto physics = std::make_unique<BroydenTridiagonal>(o.n);
  const Vector solution = root(*physics);
  return classical(std::move(physics), Vector::Constant(o.n, -1), draw, 0, solution);
}

}  // namespace

void register_broyden_tridiagonal(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "broyden-tridiagonal",
       .title = "Broyden's tridiagonal function",
       .group = Group::classical,
       .formula = "fᵢ = (3 − 2xᵢ)xᵢ − xᵢ₋₁ − 2xᵢ₊₁ + 1,  x₀ = xₙ₊₁ = 0,  L = ½Σfᵢ²",
       .source = "Moré, Garbow, Hillstrom (1981), problem 30; Broyden (1965)",
       .note = "The error in x is to the root that Newton's method finds from the standard start."},
      make_broyden_tridiagonal));
}

}  // namespace isoline::problems
