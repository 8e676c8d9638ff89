// An inverse of the flow that knows nothing of how its data were made: steps of Gauss-Newton on
// ½‖y − y*‖² from x₀, over the ten coarsest divergence-free velocities, the two constants and the
// curls of cos and sin of the modes |n| = (1, 0), (0, 1), (1, 1), (1, −1). Ten pushforwards a step,
// then halvings of it until the misfit falls.
#pragma once

#include "problems/physics/low_pass.h"
#include "problems/physics/simulation.h"

namespace isoline::problems {

class CoarseInverse {
 public:
  static constexpr Index kModes = 10, kSteps = 2;

  explicit CoarseInverse(Index N);

  // x0 and x (2N²) at the centres, y the marker wanted after its low pass. False where no step
  // lowers the misfit; x is x0 then.
  bool invert(Simulation& flow, LowPass& low_pass, VectorRef x0, VectorRef first, VectorRef y,
              VectorOut x);

 private:
  bool step(Simulation& flow, LowPass& low_pass, VectorRef first, VectorRef y, VectorOut x);
  Real misfit(Simulation& flow, LowPass& low_pass, VectorRef x, VectorRef first, VectorRef y);

  Index cells_;   // N²
  Matrix modes_;  // (2N², 10)
  Matrix moved_;  // (N², 10) what they do to y
  FlowRun run_;
  Vector tangent_;   // (3N²)
  Vector residual_;  // (N²)
  Vector trial_;     // (2N²)
};

}  // namespace isoline::problems
