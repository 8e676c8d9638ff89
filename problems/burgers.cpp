// Viscous flow on a ring backwards: u(0) from u(T) under Burgers' equation. It is the first
// nonlinear inverse problem of Thuerey et al., Physics-based Deep Learning. The initial states and
// sizes are our own; burgers_flow.h has the physics.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/trace.h"
#include "problems/burgers_flow.h"
#include "problems/exact_data.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

struct Options {
  Index N = 64, steps = 0;
  Real viscosity = 0.005, time = 0.1;
  Learning learning{.network = "mlp[layers=128-128]", .batch = 64};
};
void fields(Options& o, auto& field) {
  field("N", o.N, between(4, 4096), "cells of the ring");
  field("steps", o.steps, between(0, 1e6),
        "time steps; 0: the number that T N/steps ≤ ½ and ν T N²/steps ≤ 0.4 require");
  field("viscosity", o.viscosity, between(0, 10), "viscosity ν");
  field("time", o.time, between(1e-6, 10), "time T between the two states");
  fields(o.learning, field);
}

std::unique_ptr<BurgersFlow> flow_of(const Options& o) {
  return std::make_unique<BurgersFlow>(o.N, o.steps, o.viscosity, o.time);
}

// x*: four waves of random phase, the n-th of the size 1/n, the largest speed 1. (N)
Vector random_state(Index N, RandomStream& stream) {
  constexpr int kWaves = 4;
  const Vector coefficients = stream.normal_vector(Index{2} * kWaves);
  Vector state = Vector::Zero(N);
  for (int n = 1; n <= kWaves; ++n)
    for (Index j = 0; j < N; ++j) {
      const Real angle = 2 * std::numbers::pi * n * static_cast<Real>(j) / static_cast<Real>(N);
      state[j] +=
          (coefficients[2 * n - 2] * std::cos(angle) + coefficients[2 * n - 1] * std::sin(angle)) /
          n;
    }
  return state / state.cwiseAbs().maxCoeff();
}

// All steps if they are few, otherwise as many as can be distinguished and stored.
Field field_of(const BurgersFlow& flow, Real time) {
  constexpr Index kMostTimes = 65;
  const Index room = Trace::Frames::kCells / flow.inputs();
  return {.rows = std::min({flow.steps() + 1, kMostTimes, room}),
          .columns = flow.inputs(),
          .x = {"speed before"},
          .y = {"speed after"},
          .time = time};
}

History history_of(std::shared_ptr<const BurgersFlow> flow) {
  return [flow = std::move(flow)](VectorRef x, BatchOut states) { flow->history(x, states); };
}

ProblemParts learn_burgers(const Options& o, const Draw& draw) {
  const auto physics = std::shared_ptr<const BurgersFlow>(flow_of(o));
  const auto sample = [physics](RandomStream& stream, Index b, Batch& batch) {
    batch.truth.col(b) = random_state(physics->inputs(), stream);
    physics->evolve(batch.truth.col(b), batch.target.col(b));
    batch.input.col(b) = batch.target.col(b);
  };
  const auto mean_distance = [](BatchRef x, const Batch& batch) {
    return (x - batch.truth).colwise().norm().mean();
  };
  return learn(o.learning, {.inputs = o.N, .outputs = o.N}, draw,
               {.physics = flow_of(o),
                .x_error = mean_distance,
                .samples = {.draw = sample},
                .field = field_of(*physics, o.time),
                .history = history_of(physics)});
}

ProblemParts make_burgers(const Options& o, const Draw& draw) {
  if (o.learning.is_on()) return learn_burgers(o, draw);
  RandomStream stream = draw.stream("target");
  const auto shown = std::shared_ptr<const BurgersFlow>(flow_of(o));
  ProblemParts parts =
      from_exact_data(flow_of(o), random_state(o.N, stream), field_of(*shown, o.time), draw);
  parts.history = history_of(shown);
  return parts;
}

}  // namespace

void register_burgers(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "burgers",
       .title = "Burgers’ equation backwards",
       .group = Group::physics,
       .formula = "u̇ = −u ∂u + ν ∂²u,  x = u(0),  P(x) = u(T),  L = ½‖P(x) − y*‖²",
       .source = "Thuerey et al., Physics-based Deep Learning, chapters on Burgers’ equation",
       .note =
           "x* is a sum of four waves with a largest speed of 1, from our own random streams for "
           "seed 0, too. By the time T its slopes have steepened, and viscosity has smoothed "
           "them. P is one to one but keeps less than a thousandth of the finest waves. Seeds "
           "from 1 on start with noise of 0.1 per cell, which the data hardly determine. The "
           "local inverse simulates backward without viscosity.",
       .aim = Aim::x,
       .panels = {{.title = "Learning curves", .kind = "curve"}}},
      make_burgers));
}

}  // namespace isoline::problems
