// Problems with known answers for the audit: physics of two inputs that are chains of invertible
// links, so that a change of units is one link more, and derivatives and inverse stay exact.
#pragma once

#include <functional>
#include <vector>

#include "problems/problem.h"

namespace isoline::benchmarks {

using problems::Problem;

// One invertible map, with its derivatives.
struct Link {
  std::function<Vector(VectorRef x)> value;
  std::function<Matrix(VectorRef x)> derivative;
  std::function<Matrix(VectorRef x, VectorRef u)> second;                       // Σ uᵢ ∇²Pᵢ
  std::function<bool(VectorRef y, VectorRef x0, Eigen::Ref<Vector> x)> invert;  // near x0
};
using Chain = std::vector<Link>;  // the first is applied first

// x = A x' + b
struct Change {
  Matrix A;
  Vector b;
  Vector forward(VectorRef x) const { return A * x + b; }
  Vector backward(VectorRef x) const;
};
inline constexpr std::size_t kChanges = 3;  // diagonal, rotated, affine
Change change_of(std::size_t kind);

// The bent problem, of which all but `slope` and `singular` are variants.
Problem bent_problem();
Problem scaled_loss(Real c);              // L → cL
Problem scaled_output(Real s);            // y → sy, y* → sy*
Problem scaled_input(Real s);             // x' = x/s
Problem slope(Real alpha);                // L = αx, of one unknown; y* is one below y
Problem changed_input(const Change& x);   // in x', where x = A x' + b
Problem changed_output(const Change& y);  // of y' = A y + b, y*' = A y* + b

// The bent problem behind a network, x = N(y*; θ), for methods that teach one: eight fixed samples,
// which the network sees in the same numbers however y is written.
inline constexpr const char* kTaughtNetwork = "mlp[layers=6,activation=tanh,precision=double]";
Problem taught_loss(Real c);
inline Problem taught_problem() { return taught_loss(1); }
Problem taught_output(Real s);
Problem taught_change(const Change& y);

// A start near a solution x*, at which J is regular or singular.
struct Vicinity {
  Problem problem;
  Vector solution;
};
Vicinity regular_vicinity();
Vicinity singular_vicinity();  // P(x) = (x₁ − x₁*, (x₂ − x₂*)²)

// L(z(x)): the same loss as a function of z, and of x through the stage z.
struct Composition {
  Chain stage;  // x ↦ z
  Problem inner, whole;
};
Composition linear_composition();
Composition curved_composition();
Vector value_of(const Chain& chain, VectorRef x);

}  // namespace isoline::benchmarks
