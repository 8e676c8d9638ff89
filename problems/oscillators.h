// Two coupled oscillators. The unknown is the control of the second one that returns both to their
// initial state. linear-chain and coupled-oscillators share this physics and data.
// Schnell, Holl, Thuerey (2022), published scripts, and the Physics-based Deep Learning book.
#pragma once

#include "problems/physics.h"

namespace isoline::problems {

// ẋ = v,  v̇₁ = −x₁ + cδ + αδ³,  v̇₂ = −x₂ − cδ − αδ³ + γu(t),  δ = x₂ − x₁; unit masses
struct Forces {
  Real linear, cubic, gain;  // c, α, γ
};

// The state (x₁, x₂, v₁, v₂) after T steps Δt of the classical Runge-Kutta method, u constant in
// each: x = (u₁, …, u_T), context the state at the beginning. Derivatives are those of the steps
// themselves: δ at each of their stages is all that the linearized steps need.
class Oscillators : public Physics {
 public:
  Oscillators(Forces forces, Index steps, Real step) : forces_(forces), steps_(steps), dt_(step) {}
  Index inputs() const override { return steps_; }
  Index outputs() const override { return 4; }

  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const override;
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override;
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override;

 private:
  Forces forces_;
  Index steps_;  // T
  Real dt_;      // Δt
};

}  // namespace isoline::problems
