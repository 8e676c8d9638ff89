// The flow of one sample over several steps, forward, with all derivatives, and backward in time.
// Checkpoints are the states between steps: what lies within a step its derivatives compute again,
// so that 8 steps of 64 samples on 64×64 cells keep 90 MB.
#pragma once

#include "problems/physics/flow_step.h"

namespace isoline::problems {

// The states of a run that its derivatives need, allocated by the first run.
struct FlowRun {
  Matrix states;     // (3N², steps + 1) u, v, m
  Matrix projected;  // (2N², steps)

  Eigen::Ref<const Vector> velocity(Index step) const {
    return states.col(step).head(states.rows() / 3 * 2);
  }
  Eigen::Ref<const Vector> marker(Index step) const {
    return states.col(step).tail(states.rows() / 3);
  }
};

// Owns its work space: use one object per thread.
class Simulation {
 public:
  Simulation(const FlowOptions& options, Index steps);

  // The first state from a velocity at the centres, x and then y, (2N²): staggered, its means on
  // the faces, projected; collocated, itself, as published.
  void begin(VectorRef centred, VectorRef marker, FlowRun& run);
  void begin_pushforward(VectorRef centred, VectorOut velocity);  // (2N²) -> (2N²)
  void begin_pullback(VectorOut velocity, VectorOut centred);     // `velocity` is spent

  void forward(FlowRun& run);  // from the first state
  // From a tangent of the first state to that of the last, in place, (3N²).
  void pushforward(const FlowRun& run, VectorOut tangent);
  void pullback(const FlowRun& run, VectorOut cotangent);  // from the last to the first, in place

  void add_choices(const FlowRun& run, PieceDigest& digest);

  // The same steps with the velocity of the last state turned round, and this marker at their
  // beginning: what was, if nothing was lost.
  void reverse(const FlowRun& run, VectorRef marker, FlowRun& back);

  // Means on the centres of a velocity in this arrangement, (2N²) -> (2N²).
  void centre(VectorRef velocity, VectorOut centred) const;

 private:
  void size(FlowRun& run) const;
  bool is_staggered() const { return options_.arrangement == Arrangement::staggered; }

  FlowOptions options_;
  Index cells_, steps_;
  FlowStep step_;
  Vector moved_;  // (3N²)
};

}  // namespace isoline::problems
