// The test functions of Moré, Garbow, Hillstrom (1981): y* = 0, P(x) = f(x) as in the paper,
// L = ½ Σ fᵢ², half of the published Σ fᵢ². They are minimization problems: the success criterion
// is a small loss, the default of an entry.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "problems/more_garbow_hillstrom.h"

namespace isoline::problems {
namespace {

// f of few unknowns.
struct Formula {
  JetFunction f;
  Index inputs, outputs;
  bool (*invert)(VectorRef y, VectorRef x0, VectorOut x) = nullptr;  // exact, where there is one
};

class ByFormula final : public JetPhysics<JetFunction> {
 public:
  explicit ByFormula(const Formula& f) : JetPhysics(f.f, f.inputs, f.outputs), f_(f) {}
  Inverse inverse_kind() const override { return f_.invert ? Inverse::exact : Inverse::none; }
  bool invert(VectorRef y, VectorRef x0, VectorOut x) const override { return f_.invert(y, x0, x); }

 private:
  Formula f_;
};

bool invert_rosenbrock(VectorRef y, VectorRef, VectorOut x) {
  x[0] = 1 - y[1];
  x[1] = y[0] / 10 + x[0] * x[0];
  return true;
}

bool invert_helical_valley(VectorRef y, VectorRef x0, VectorOut x) {
  constexpr Real kTurn = 2 * std::numbers::pi;
  const Real rho = 1 + y[1] / 10, theta = (y[2] - y[0] / 10) / 10;
  x = x0;
  if (!(rho > 0 && theta >= -0.25 && theta < 0.75)) return false;
  x << rho * std::cos(kTurn * theta), rho * std::sin(kTurn * theta), y[2];
  return true;
}

// x with x1 + 10 x2 = a, x3 − x4 = d, x2 − 2 x3 = p, x1 − x4 = q
Vector solve_powell(Real a, Real d, Real p, Real q) {
  const Real x1 = (a - 10 * p + 20 * (q - d)) / 21, x4 = x1 - q, x3 = x4 + d;
  return Eigen::Vector4d(x1, p + 2 * x3, x3, x4);
}

// The Jacobian is singular at the solution 0. The inverse is linear once the signs of
// p = x2 − 2 x3 and q = x1 − x4 are chosen: of the four, the nearest.
bool invert_powell_singular(VectorRef y, VectorRef x0, VectorOut x) {
  const Vector guess = x0;
  x = guess;
  if (!(y[2] >= 0 && y[3] >= 0)) return false;
  Real nearest = std::numeric_limits<Real>::infinity();
  for (const Real p : {-std::sqrt(y[2]), std::sqrt(y[2])}) {
    for (const Real q : {-std::sqrt(y[3] / std::sqrt(10.0)), std::sqrt(y[3] / std::sqrt(10.0))}) {
      const Vector candidate = solve_powell(y[0], y[1] / std::sqrt(5.0), p, q);
      const Real distance = (candidate - guess).norm();
      if (distance < nearest) x = candidate;
      nearest = std::min(nearest, distance);
    }
  }
  return true;
}

template <int standard, int least>
struct Residuals {
  Index m = standard;
};
template <int standard, int least>
void fields(Residuals<standard, least>& o, auto& field) {
  field("m", o.m, between(least, 1000), "number of residuals");
}

// Zero at (1, 10, 1), at (10, 1, −1) and all along x1 = x2, x3 = 0.
ProblemParts make_box3d(const Residuals<10, 3>& o, const Draw& draw) {
  Matrix isolated(3, 2);
  isolated << 1, 10, 10, 1, 1, -1;
  ProblemParts parts = classical(std::make_unique<JetPhysics<JetFunction>>(kBox3d, 3, o.m),
                                 Eigen::Vector3d(0, 10, 20), draw, 0, isolated);
  parts.x_error = [isolated](BatchRef x, const Batch&) {
    const Real to_line = std::hypot((x(0, 0) - x(1, 0)) / std::sqrt(2.0), x(2, 0));
    return std::min(distance_to_nearest(x, isolated), to_line);
  };
  return parts;
}

// The residuals do not vanish: Σ fᵢ² = 85822.2… at m = 20, the only m with a published minimum.
ProblemParts make_brown_dennis(const Residuals<20, 4>& o, const Draw& draw) {
  // By Newton's method in quadruple precision from the standard start, to ‖∇‖ = 1e-29.
  constexpr Real kMinimum = 42911.1008131781723303;  // ½ of the published 85822.2
  const Eigen::Vector4d minimizer(-11.5944399047621653826, 13.2036300512072038213,
                                  -0.403439488176859519644, 0.236778774455736299147);
  ProblemParts parts = classical(std::make_unique<JetPhysics<JetFunction>>(kBrownDennis, 4, o.m),
                                 Eigen::Vector4d(25, 5, -5, -1), draw, kMinimum, minimizer);
  if (o.m != 20) {
    parts.minimum.reset();
    parts.truth.reset();
    parts.x_error = nullptr;
  }
  return parts;
}

template <int least>
struct Unknowns {
  Index n = 10;
};
template <int least>
void fields(Unknowns<least>& o, auto& field) {
  field("n", o.n, between(least, 1e6), "number of unknowns");
}

// Products are O(n).
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
  void curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace&) const override {
    for (Index b = 0; b < u.cols(); ++b) out.col(b) = 2 * u(n_ + 1, b) * j_.dot(v.col(b)) * j_;
  }

 private:
  Real t(VectorRef x) const { return (j_.array() * (x.array() - 1)).sum(); }
  Index n_;
  Vector j_;  // 1…n
};

ProblemParts make_variably_dimensioned(const Unknowns<1>& o, const Draw& draw) {
  const Vector start =
      1 - Vector::LinSpaced(o.n, 1, static_cast<Real>(o.n)).array() / static_cast<Real>(o.n);
  return classical(std::make_unique<VariablyDimensioned>(o.n), start, draw, 0, Vector::Ones(o.n));
}

// Products are O(n).
class BroydenTridiagonal final : public Physics {
 public:
  explicit BroydenTridiagonal(Index n) : n_(n) {
    pattern_.columns = n;
    for (int i = 0; i < n; ++i) {
      for (int j = std::max(i - 1, 0); j < std::min(i + 2, static_cast<int>(n)); ++j)
        pattern_.column.push_back(j);
      pattern_.row_start.push_back(static_cast<int>(pattern_.column.size()));
    }
    set_single_blocks(pattern_);
  }
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
  void curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace&) const override {
    out = -4 * u.cwiseProduct(v);
  }
  const SparsePattern* sparse_pattern() const override { return &pattern_; }
  void sparse_jacobian(VectorOut values, Workspace& w) const override {
    Index p = 0;
    for (Index i = 0; i < n_; ++i) {
      if (i > 0) values[p++] = -1;
      values[p++] = 3 - 4 * w.x(i, 0);
      if (i + 1 < n_) values[p++] = -2;
    }
  }

 private:
  void add_neighbours(BatchRef v, Real lower, Real upper, BatchOut out) const {
    out.bottomRows(n_ - 1) += lower * v.topRows(n_ - 1);
    out.topRows(n_ - 1) += upper * v.bottomRows(n_ - 1);
  }
  Index n_;
  SparsePattern pattern_;
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

// The solution is the root that Newton's method finds from the standard start: quadratic, so to
// rounding in 10.
ProblemParts make_broyden_tridiagonal(const Unknowns<2>& o, const Draw& draw) {
  constexpr int kSteps = 10;
  auto physics = std::make_unique<BroydenTridiagonal>(o.n);
  const Vector start = Vector::Constant(o.n, -1);
  Vector x = start, f(o.n);
  Workspace w;
  for (int step = 0; step < kSteps; ++step) {
    physics->forward(x, Matrix(), f, w);
    x -= newton_step(x, f);
  }
  return classical(std::move(physics), start, draw, 0, x);
}

}  // namespace

void register_classical(ProblemRegistry& registry) {
  const auto add =
      [&](const char* name, const char* title, const char* formula, int problem, const char* author,
          const Formula& f, const Vector& start, const Vector& minimizer,
          std::optional<std::array<Real, 4>> window = std::nullopt, const char* note = "") {
        registry.add(
            {.name = name,
             .title = title,
             .group = Group::classical,
             .formula = std::string(formula) + ",  L = ½Σfᵢ²",
             .source = fmt::format("Moré, Garbow, Hillstrom (1981), problem {}{}", problem, author),
             .note = note,
             .make = [f, start, minimizer, window](const OptionValues&, const Draw& draw) {
               ProblemParts parts =
                   classical(std::make_unique<ByFormula>(f), start, draw, 0, minimizer);
               parts.window = window;
               return Problem(std::move(parts));
             }});
      };
  using V2 = Eigen::Vector2d;
  using V3 = Eigen::Vector3d;
  using V4 = Eigen::Vector4d;
  add("rosenbrock", "Rosenbrock's valley", "f = (10(x₂ − x₁²), 1 − x₁)", 1, "; Rosenbrock (1960)",
      {kRosenbrock, 2, 2, invert_rosenbrock}, V2(-1.2, 1), V2(1, 1), {{-2, 2, -1, 3}});
  add("brown-badly-scaled", "Brown's badly scaled function",
      "f = (x₁ − 10⁶, x₂ − 2·10⁻⁶, x₁x₂ − 2)", 4, "", {kBrownBadlyScaled, 2, 3}, V2(1, 1),
      V2(1e6, 2e-6));
  add("beale", "Beale's function", "fᵢ = yᵢ − x₁(1 − x₂ⁱ),  y = (1.5, 2.25, 2.625)", 5,
      "; Beale (1958)", {kBeale, 2, 3}, V2(1, 1), V2(3, 0.5), {{-0.5, 4.5, -1.5, 1.5}});
  add("helical-valley", "Helical valley",
      "f = (10(x₃ − 10θ), 10(ρ − 1), x₃),  (x₁, x₂) = ρ(cos 2πθ, sin 2πθ)", 7,
      "; Fletcher and Powell (1963)", {kHelicalValley, 3, 3, invert_helical_valley}, V3(-1, 0, 0),
      V3(1, 0, 0), {}, "θ jumps from ¾ to −¼ across x₁ = 0 > x₂.");
  add("powell-singular", "Powell's singular function",
      "f = (x₁ + 10x₂, √5(x₃ − x₄), (x₂ − 2x₃)², √10(x₁ − x₄)²)", 13, "; Powell (1962)",
      {kPowellSingular, 4, 4, invert_powell_singular}, V4(3, -1, 0, 1), Vector::Zero(4));
  add("wood", "Wood's function",
      "f = (10(x₂ − x₁²), 1 − x₁, √90(x₄ − x₃²), 1 − x₃, √10(x₂ + x₄ − 2), (x₂ − x₄)/√10)", 14,
      "; Colville (1968)", {kWood, 4, 6}, V4(-3, -1, -3, -1), Vector::Ones(4));
  registry.add(problem_entry(
      {.name = "box3d",
       .title = "Box's three-dimensional function",
       .group = Group::classical,
       .formula = "fᵢ = exp(−tᵢx₁) − exp(−tᵢx₂) − x₃(exp(−tᵢ) − exp(−10tᵢ)),  tᵢ = i/10,  "
                  "L = ½Σfᵢ²",
       .source = "Moré, Garbow, Hillstrom (1981), problem 12; Box (1966)"},
      make_box3d));
  registry.add(problem_entry(
      {.name = "brown-dennis",
       .title = "Brown and Dennis' function",
       .group = Group::classical,
       .formula = "fᵢ = (x₁ + tᵢx₂ − exp tᵢ)² + (x₃ + x₄ sin tᵢ − cos tᵢ)²,  tᵢ = i/5,  L = ½Σfᵢ²",
       .source = "Moré, Garbow, Hillstrom (1981), problem 16; Brown and Dennis (1971)",
       .note = "The residuals do not vanish. The minimum is known for m = 20 only; the truth is "
               "the minimizer."},
      make_brown_dennis));
  registry.add(
      problem_entry({.name = "variably-dimensioned",
                     .title = "Variably dimensioned function",
                     .group = Group::classical,
                     .formula = "fᵢ = xᵢ − 1,  fₙ₊₁ = t,  fₙ₊₂ = t²,  t = Σ j(xⱼ − 1),  L = ½Σfᵢ²",
                     .source = "Moré, Garbow, Hillstrom (1981), problem 25"},
                    make_variably_dimensioned));
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
