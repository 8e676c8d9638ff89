// The oscillators' steps, their derivatives, and the data.
#include "problems/oscillators.h"

#include "problems/learning.h"
#include "problems/sample_lanes.h"

namespace isoline::problems {
namespace {

using State = LanesOf<4>;  // (x₁, x₂, v₁, v₂)

constexpr Index kStages = 4;

// s after Δt, where rate(j, s) is ṡ in stage j.
template <class Rate>
State runge_kutta(const State& s, Real dt, const Rate& rate) {
  const State k1 = rate(0, s);
  const State k2 = rate(1, s + dt / 2 * k1);
  const State k3 = rate(2, s + dt / 2 * k2);
  const State k4 = rate(3, s + dt * k3);
  return s + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

// ṡ where the spring pulls the first mass, and the second back, with this force.
State motion(const State& s, const Lanes& spring, const Lanes& push) {
  State rate;
  rate.leftCols<2>() = s.rightCols<2>();
  rate.col(2) = spring - s.col(0);
  rate.col(3) = push - spring - s.col(1);
  return rate;
}

// Its transpose, for the spring's force D δ: the cotangent of s, from that of ṡ.
State motion_transposed(const State& r, const Lanes& D) {
  const Lanes spring = D * (r.col(2) - r.col(3));
  State cotangent;
  cotangent.col(0) = -r.col(2) - spring;
  cotangent.col(1) = -r.col(3) + spring;
  cotangent.rightCols<2>() = r.leftCols<2>();
  return cotangent;
}

Lanes stretch(const State& s) { return s.col(1) - s.col(0); }  // δ

// The results of a forward pass, and scratch arrays for the controls of a group.
struct Steps {
  Matrix& slopes;  // D = c + 3αδ² of each stage, (8, 4 T ⌈B/8⌉)
  Matrix& lanes;   // of controls, (8, T)

  Steps(Workspace& w, Index steps, Index samples) : slopes(sized(w)[0]), lanes(w.saved[1]) {
    slopes.resize(kLanes, kStages * steps * groups_of_lanes(samples));
    lanes.resize(kLanes, steps);
  }
  static std::vector<Matrix>& sized(Workspace& w) {
    w.saved.resize(2);
    return w.saved;
  }
  Eigen::Map<Lanes> slope(Index group, Index step, Index stage) const {
    return lanes_at(slopes, (group * lanes.cols() + step) * kStages + stage);
  }
  Eigen::Map<Lanes> control(Index step) const { return lanes_at(lanes, step); }
};

constexpr const char* kFirstX1 = "x1 of the first sample";
constexpr const char* kFirstX2 = "x2 of the first sample";

State state_of(BatchRef states, Index first, Index count) {
  State s;
  gather(states, first, count, s);
  return s;
}

}  // namespace

void Oscillators::forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const {
  const Steps steps(w, steps_, x.cols());
  by_lanes(x.cols(), [&](Index group, Index first, Index count) {
    gather(x, first, count, steps.lanes);
    State s = state_of(c, first, count);
    for (Index t = 0; t < steps_; ++t)
      s = runge_kutta(s, dt_, [&](Index stage, const State& at) -> State {
        const Lanes delta = stretch(at), cubic = forces_.cubic * delta.square();
        steps.slope(group, t, stage) = forces_.linear + 3 * cubic;
        return motion(at, (forces_.linear + cubic) * delta, forces_.gain * steps.control(t));
      });
    scatter(s, first, count, y);
  });
}

void Oscillators::pushforward(BatchRef v, BatchOut Jv, Workspace& w) const {
  const Steps steps(w, steps_, v.cols());
  by_lanes(v.cols(), [&](Index group, Index first, Index count) {
    gather(v, first, count, steps.lanes);
    State ds = State::Zero();
    for (Index t = 0; t < steps_; ++t)
      ds = runge_kutta(ds, dt_, [&](Index stage, const State& at) -> State {
        const Lanes spring = steps.slope(group, t, stage) * stretch(at);
        return motion(at, spring, forces_.gain * steps.control(t));
      });
    scatter(ds, first, count, Jv);
  });
}

// Reverse through the stages: λ the cotangent of the state, r_j that of k_j.
void Oscillators::pullback(BatchRef u, BatchOut JTu, Workspace& w) const {
  const Steps steps(w, steps_, u.cols());
  by_lanes(u.cols(), [&](Index group, Index first, Index count) {
    State lambda = state_of(u, first, count);
    for (Index t = steps_; t-- > 0;) {
      const State r4 = dt_ / 6 * lambda;
      const State s4 = motion_transposed(r4, steps.slope(group, t, 3));
      const State r3 = dt_ / 3 * lambda + dt_ * s4;
      const State s3 = motion_transposed(r3, steps.slope(group, t, 2));
      const State r2 = dt_ / 3 * lambda + dt_ / 2 * s3;
      const State s2 = motion_transposed(r2, steps.slope(group, t, 1));
      const State r1 = dt_ / 6 * lambda + dt_ / 2 * s2;
      const State s1 = motion_transposed(r1, steps.slope(group, t, 0));
      steps.control(t) = forces_.gain * (r1.col(3) + r2.col(3) + r3.col(3) + r4.col(3));
      lambda += s1 + s2 + s3 + s4;
    }
    scatter(steps.lanes, first, count, JTu);
  });
}

ProblemParts return_to_start(const ReturnOptions& o, std::unique_ptr<Physics> physics,
                             const Draw& draw) {
  const Index controls = physics->inputs();
  ProblemParts parts{.physics = std::move(physics),
                     .loss = std::make_unique<HalfSquared>(o.loss == "square" ? 2 : 1)};
  if (!o.learning.is_on()) {
    const Vector state = draw.stream("target").uniform_vector(4, 0, 1);
    parts.start = draw.start(Vector::Zero(controls));
    parts.context = parts.target = state;
    parts.minimum = 0;
    return parts;
  }
  parts.samples = {.epoch = o.epoch,
                   .contexts = 4,
                   .has_truth = false,
                   .draw = [](RandomStream& stream, Index b, Batch& batch) {
                     batch.target.col(b) = stream.uniform_vector(4, 0, 1);
                     batch.context.col(b) = batch.input.col(b) = batch.target.col(b);
                   }};
  parts = learn(o.learning, {.inputs = 4, .outputs = controls}, draw, std::move(parts));
  const Network& network = *parts.network;
  const auto first = [](const Batch&) -> Index { return 0; };
  parts.series = joined(std::move(parts.series),
                        joined(hidden_activity(network), saturation(network, /*shown=*/0)));
  parts.series = joined(std::move(parts.series), path({kFirstX1, kFirstX2}, first));
  return parts;
}

}  // namespace isoline::problems
