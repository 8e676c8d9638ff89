// A quantum particle in the box [0, 2] under a field u(t) along it, iψ̇ = H(u)ψ with
// H(u) = −∂² + u(t) x (ħ = 1, mass ½), from its ground state ψ₁. Crank, Nicolson (1947), on 14
// interior points Δx = 2/15 apart, in steps that last 19.2 together, 384 of Δt = 0.05 as published,
// with u constant in each; complex numbers as (re, im) in turn. With M = 1 + iΔt/2 H and φ = M⁻¹ψ a
// step is ψ⁺ = M* M⁻¹ψ = 2φ − ψ, which keeps ‖ψ‖, and
//
//   ∂ψ⁺/∂u = −iΔt M⁻¹ (x ∘ φ).
//
// Backwards M* stands for M, for H is real and symmetric: μ = M*⁻¹λ⁺, λ = 2μ − λ⁺, and
// ∂L/∂u = Re⟨μ, −iΔt x ∘ φ⟩.
#pragma once

#include <complex>

#include "problems/physics.h"

namespace isoline::problems {

// The complex numbers that (re, im) in turn are, (k/2, B).
using ComplexBatch = Eigen::Map<const Eigen::MatrixXcd, 0, Eigen::OuterStride<>>;
using ComplexBatchOut = Eigen::Map<Eigen::MatrixXcd, 0, Eigen::OuterStride<>>;
ComplexBatch complex_of(BatchRef y);
ComplexBatchOut complex_in(BatchOut y);

class ParticleInABox final : public Physics {
 public:
  static constexpr Index kPoints = 14, kSteps = 384;  // as published
  static constexpr Real kStep = 0.05;

  // Output is ψ at the end; or, for a given as context, (14, B), what of it is missing at the real
  // state a: (I − aaᵀ)ψ.
  enum class Output { state, missing };
  explicit ParticleInABox(Output output, Index steps = kSteps)
      : output_(output),
        steps_(steps),
        dt_(kStep * (static_cast<Real>(kSteps) / static_cast<Real>(steps))) {}

  static Vector eigenstate(Index k);  // ψ_k, of H(0): sin(kπx/2), of norm 1, (14)

  Index inputs() const override { return steps_; }
  Index outputs() const override { return 2 * kPoints; }
  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const override;
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override;
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override;
  void jacobian(BatchOut J, Workspace& w) const override;

 private:
  void project(BatchRef a, Index columns, BatchOut y) const;

  Output output_;
  Index steps_;
  Real dt_;  // Δt
};

}  // namespace isoline::problems
