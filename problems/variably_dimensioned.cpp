// The variably dimensioned function: fᵢ = xᵢ − 1 for i ≤ n, fₙ₊₁ = t, fₙ₊₂ = t², with
// t = Σ j (xⱼ − 1). Moré, Garbow, Hillstrom (1981), problem 25. Products are O(n).
#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

struct Options {
  Index n = 10;
};
void fields(Options& o, auto& field) { field("n", o.n, between(1, 1e6), "number of unknowns"); }

class VariablyDimensioned final : public Physics {
 public:
  explicit VariablyDimensioned(Index n)
      : n_(n), j_(Vector::LinSpaced(n, 1, static_cast<Real>(n))) {}
  Index inputs() const override { return n_; }
  Index outputs() const override { return n_ + 2; }

  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override {
    for (Index b = 0; b < x.cols(); ++b) {
      y.col(b).head(n_) = x.col(b).array() - 1;
      const Real t = j_.dot(y.col(b).head(n_));
      y.col(b).tail(2) << t, t * t;
    }
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    for (Index b = 0; b < v.cols(); ++b) {
      const Real dt = j_.dot(v.col(b));
      Jv.col(b).head(n_) = v.col(b);
      Jv.col(b).tail(2) << dt, 2 * t(w.x.col(b)) * dt;
    }
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    for (Index b = 0; b < u.cols(); ++b)
      JTu.col(b) = u.col(b).head(n_) + (u(n_, b) + 2 * t(w.x.col(b)) * u(n_ + 1, b)) * j_;
  }
  bool has_curvature() const override { return true; }
  void curvature(BatchRef u, BatchOut out, Workspace&) const override {
    for (Index b = 0; b < u.cols(); ++b)
      out.middleCols(b * n_, n_).noalias() = (2 * u(n_ + 1, b) * j_) * j_.transpose();
  }

 private:
  Real t(VectorRef x) const { return (j_.array() * (x.array() - 1)).sum(); }
  Index n_;
  Vector j_;  // 1…n
};

ProblemParts make_variably_dimensioned(const Options& o, const Draw& draw) {
  const Vector start =
      1 - Vector::LinSpaced(o.n, 1, static_cast<Real>(o.n)).array() / static_cast<Real>(o.n);
  return classical(std::make_unique<VariablyDimensioned>(o.n), start, draw, 0, Vector::Ones(o.n));
}

}  // namespace

void register_variably_dimensioned(ProblemRegistry& registry) {
  registry.add(
      problem_entry({.name = "variably-dimensioned",
                     .title = "Variably dimensioned function",
                     .group = Group::classical,
                     .formula = "fᵢ = xᵢ − 1,  fₙ₊₁ = t,  fₙ₊₂ = t²,  t = Σ j(xⱼ − 1),  L = ½Σfᵢ²",
                     .source = "Moré, Garbow, Hillstrom (1981), problem 25"},
                    make_variably_dimensioned));
}

}  // namespace isoline::problems
