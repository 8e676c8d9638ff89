// Burgers' equation u̇ = −u ∂u + ν ∂²u on the ring [0, 1): x is the state at the beginning, y = P(x)
// that at time T, on N cells of width h. With λ = Δt/6h and μ = νΔt/h² the slope in space is
//
//   Δt r(u)ⱼ = −λ (uⱼ₊₁ − uⱼ₋₁)(uⱼ₋₁ + uⱼ + uⱼ₊₁) + μ (uⱼ₋₁ − 2uⱼ + uⱼ₊₁),
//
// whose first term keeps Σu and Σu² (Zabusky and Kruskal, 1965), and a step in time is Heun's,
// v = u + Δt r(u), u' = ½ (u + v + Δt r(v)). Both are of second order and polynomials in u: without
// limiter or interpolation, the derivatives are those of the steps themselves everywhere.
//
// The local inverse uses a reverse simulation R: the same steps backward without viscosity, which
// would amplify the finest waves without bound. R restores the transport but not what viscosity has
// smoothed. It is approximate, and corrects x₀ by the difference, x̃ = x₀ + R(y) − R(P(x₀)), so that
// x̃ = x₀ if y is already reached.
#pragma once

#include "problems/physics.h"

namespace isoline::problems {

class BurgersFlow final : public Physics {
 public:
  // steps = 0: the number that Δt/h ≤ ½ and νΔt/h² ≤ 0.4 require. A usage error if the steps are
  // too few to be stable at speeds of 1.
  BurgersFlow(Index N, Index steps, Real viscosity, Real time);
  Index inputs() const override { return N_; }
  Index outputs() const override { return N_; }
  Index steps() const { return steps_; }

  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const override;
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override;
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override;

  Inverse inverse_kind() const override { return Inverse::approximate; }
  Index inverse_price() const override { return 3; }  // P(x₀) and two reverse simulations
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const override;

  void evolve(VectorRef x, VectorOut y) const;  // y = P(x), nothing kept
  // States from x to y, each a row of (rows, N): at the steps nearest to evenly spread times.
  void history(VectorRef x, BatchOut states) const;
  void reverse(VectorRef y, VectorOut x) const;  // x = R(y)

 private:
  Index N_, steps_;
  Real lambda_, mu_;
};

}  // namespace isoline::problems
