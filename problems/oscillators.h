// Two coupled oscillators. The unknown is the control of the second one that returns both to their
// initial state. linear-chain and coupled-oscillators share this physics and data.
// Schnell, Holl, Thuerey (2022), published scripts, and the Physics-based Deep Learning book.
#pragma once

#include <memory>

#include "problems/learning.h"

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

struct ReturnOptions {
  std::string loss;
  Index epoch = 4096;
  Learning learning;
};
inline void fields(ReturnOptions& o, auto& field) {
  field("loss", o.loss, {"", "square"}, "square: ‖y − y*‖², as published, instead of half of it");
  field(kEpochOption, o.epoch, between(0, 1e6),
        "N: mode=learn takes the same N samples batch by batch, again and again; 0: new "
        "samples in each step");
  fields(o.learning, field);
}

// Data and start of the problem over that physics: y* is the initial state, sampled from U[0, 1)⁴,
// and the network's input; the standard start of one problem is u = 0.
ProblemParts return_to_start(const ReturnOptions& options, std::unique_ptr<Physics> physics,
                             const Draw& draw);

}  // namespace isoline::problems
