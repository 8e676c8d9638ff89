// Steps in order, their tangents in the same order, their cotangents from the last to the first.
#include "problems/physics/simulation.h"

#include "core/errors.h"
#include "problems/physics/lattice.h"

namespace isoline::problems {

Simulation::Simulation(const FlowOptions& options, Index steps)
    : options_(options),
      cells_(options.cells()),
      steps_(steps),
      step_(options),
      moved_(3 * cells_) {
  require(steps > 0, "a simulation needs at least one step");
}

void Simulation::size(FlowRun& run) const {
  run.states.resize(3 * cells_, steps_ + 1);
  run.projected.resize(2 * cells_, steps_);
}

void Simulation::begin(VectorRef centred, VectorRef marker, FlowRun& run) {
  size(run);
  begin_pushforward(centred, run.states.col(0).head(2 * cells_));  // it is linear
  run.states.col(0).tail(cells_) = marker;
}

void Simulation::begin_pushforward(VectorRef centred, VectorOut velocity) {
  if (!is_staggered()) {
    velocity = centred;
    return;
  }
  weigh(options_.N, 0.5, 0.5, Side::left, centred.head(cells_), velocity.head(cells_));
  weigh(options_.N, 0.5, 0.5, Side::below, centred.tail(cells_), velocity.tail(cells_));
  step_.projection().apply(velocity.head(cells_), velocity.tail(cells_));
}

void Simulation::begin_pullback(VectorOut velocity, VectorOut centred) {
  if (is_staggered()) step_.projection().apply(velocity.head(cells_), velocity.tail(cells_));
  centre(velocity, centred);
}

void Simulation::centre(VectorRef velocity, VectorOut centred) const {
  if (!is_staggered()) {
    centred = velocity;
    return;
  }
  weigh(options_.N, 0.5, 0.5, Side::right, velocity.head(cells_), centred.head(cells_));
  weigh(options_.N, 0.5, 0.5, Side::above, velocity.tail(cells_), centred.tail(cells_));
}

void Simulation::forward(FlowRun& run) {
  for (Index n = 0; n < steps_; ++n)
    step_.forward(run.states.col(n), run.states.col(n + 1), run.projected.col(n));
}

void Simulation::pushforward(const FlowRun& run, VectorOut tangent) {
  for (Index n = 0; n < steps_; ++n) {
    step_.pushforward(run.states.col(n), run.states.col(n + 1), run.projected.col(n), tangent,
                      moved_);
    tangent = moved_;
  }
}

void Simulation::pullback(const FlowRun& run, VectorOut cotangent) {
  for (Index n = steps_; n-- > 0;)
    step_.pullback(run.states.col(n), run.states.col(n + 1), run.projected.col(n), cotangent);
}

void Simulation::add_choices(const FlowRun& run, PieceDigest& digest) {
  for (Index n = 0; n < steps_; ++n)
    step_.add_choices(run.states.col(n), run.states.col(n + 1), digest);
}

void Simulation::reverse(const FlowRun& run, VectorRef marker, FlowRun& back) {
  size(back);
  back.states.col(0).head(2 * cells_) = -run.velocity(steps_);
  back.states.col(0).tail(cells_) = marker;
  forward(back);
}

}  // namespace isoline::problems
