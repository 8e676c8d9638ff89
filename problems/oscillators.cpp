// The oscillators' steps, their derivatives, and the data.
#include "problems/oscillators.h"

#include "core/decompose.h"
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

namespace {

// The motion lasts as long for all numbers of steps.
constexpr Real kDuration = 12;
constexpr Index kChainSteps = 24, kCoupledSteps = 96;

template <bool is_chain>
struct ReturnOptions {
  Index steps = is_chain ? kChainSteps : kCoupledSteps;
  std::string loss;
  Index epoch = 4096;
  Learning learning{
      .network = is_chain ? "mlp[layers=20-20-20,activation=tanh,precision=double,init=glorot]"
                          : "mlp[layers=20-20-20,activation=relu,precision=double,init=glorot]",
      .batch = is_chain ? 32 : 128};
};
template <bool is_chain>
void fields(ReturnOptions<is_chain>& o, auto& field) {
  field("steps", o.steps, between(24, 1536),
        "number of time steps, each with one control; the total time is 12 for any number");
  field("loss", o.loss, {"", "square"}, "square: ‖y − y*‖², as published, instead of half of it");
  field(kEpochOption, o.epoch, between(0, 1e6),
        "N: mode=learn takes the same N samples batch by batch, again and again; 0: new "
        "samples in each step");
  fields(o.learning, field);
}

// Data and start of the problem over that physics: y* is the initial state, sampled from U[0, 1)⁴,
// and the network's input; the standard start of one problem is u = 0.
ProblemParts return_to_start(const auto& o, std::unique_ptr<Physics> physics, const Draw& draw) {
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
  add_neurons(parts);
  const auto first = [](const Batch&) -> Index { return 0; };
  parts.series = joined(std::move(parts.series),
                        path({"x1 of the first sample", "x2 of the first sample"}, first));
  return parts;
}

// The linear chain of the Physics-based Deep Learning book, chapter on half-inverse gradients: two
// masses on springs, coupled by a third, one of them pushed,
//
//   ẋ = v,  v̇₁ = −x₁ + 0.2 (x₂ − x₁),  v̇₂ = −x₂ − 0.2 (x₂ − x₁) + u(t),
//
// over 24 Runge-Kutta steps of 0.5 (steps=T: of 12/T) in each of which u is constant. They shall
// return to where they began. P is affine in u, P(u; c) = A u + Φ c with A (4, T) and the initial
// state c, so its inverse is x₀ + A⁺(y − P(x₀; c)), the control nearest x₀; the book cuts singular
// values of A off at 1e-5 of the largest.
class LinearChain final : public Oscillators {
 public:
  explicit LinearChain(Index steps)
      : Oscillators({.linear = 0.2, .cubic = 0, .gain = 1}, steps, kDuration / Real(steps)) {
    Workspace w;
    Matrix A(4, steps), Phi(4, 4);
    forward(Matrix::Identity(steps, steps), Matrix::Zero(4, steps), A, w);
    forward(Matrix::Zero(steps, 4), Matrix::Identity(4, 4), Phi, w);
    Svd svd;
    require(thin_svd(A, svd), "the chain's Jacobian has no singular values");
    constexpr Real kCutoff = 1e-5;
    const Vector kept =
        (svd.sigma.array() > kCutoff * svd.sigma[0]).select(svd.sigma.cwiseInverse(), 0);
    A_plus_ = svd.Vt.transpose() * kept.asDiagonal() * svd.U.transpose();
    A_plus_A_ = A_plus_ * A;
    A_plus_Phi_ = A_plus_ * Phi;
  }

  bool has_curvature() const override { return true; }
  void curvature(BatchRef, BatchOut out, Workspace&) const override { out.setZero(); }
  void curvature_product(BatchRef, BatchRef, BatchOut out, Workspace&) const override {
    out.setZero();
  }

  Inverse inverse_kind() const override { return Inverse::exact; }
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const override {
    x = x0;
    x.noalias() += A_plus_ * y;
    x.noalias() -= A_plus_A_ * x0;
    x.noalias() -= A_plus_Phi_ * c;
    return Success::Constant(y.cols(), true);
  }

 private:
  Matrix A_plus_, A_plus_A_, A_plus_Phi_;  // (T, 4), (T, T), (T, 4)
};

ProblemParts make_linear_chain(const ReturnOptions<true>& o, const Draw& draw) {
  const auto physics = std::make_shared<const LinearChain>(o.steps);
  ProblemParts parts = return_to_start(o, std::make_unique<LinearChain>(o.steps), draw);
  parts.x_error = [physics](BatchRef x, const Batch& batch) {
    Matrix nearest(x.rows(), x.cols());
    physics->local_inverse(batch.target, x, batch.context, nearest);
    return (nearest - x).colwise().norm().mean();
  };
  return parts;
}

// The nonlinear coupled oscillators of Schnell, Holl, Thuerey (2022), published scripts: two masses
// on springs of their own, coupled by the cube of their distance, one of them pushed,
//
//   ẋ = v,  v̇₁ = −x₁ + (x₂ − x₁)³,  v̇₂ = −x₂ − (x₂ − x₁)³ + 3u(t),
//
// over 96 Runge-Kutta steps of 0.125 (steps=T: of 12/T) in each of which u is constant. They shall
// return to where they began. The scripts' network rectifies (ReLU), the book's is of hyperbolic
// tangents.
ProblemParts make_coupled_oscillators(const ReturnOptions<false>& o, const Draw& draw) {
  constexpr Forces kForces{.linear = 0, .cubic = 1, .gain = 3};
  return return_to_start(
      o, std::make_unique<Oscillators>(kForces, o.steps, kDuration / Real(o.steps)), draw);
}

std::vector<Panel> panels_of(const char* curves) {
  return {{.title = curves, .kind = "curve"},
          {.title = "Saturated neurons", .kind = "series", .quantity = "saturated neurons"},
          {.title = "Path of the first sample",
           .kind = "path",
           .quantity = "x1 of the first sample|x2 of the first sample"}};
}

}  // namespace

void register_oscillators(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "linear-chain",
       .title = "Linear chain",
       .group = Group::physics,
       .formula = "ẍ₁ = −x₁ + 0.2 (x₂ − x₁),  ẍ₂ = −x₂ − 0.2 (x₂ − x₁) + u(t),  y* = the initial "
                  "state",
       .source = "Thuerey et al., Physics-based Deep Learning, chapter on half-inverse gradients; "
                 "Schnell, Holl, Thuerey (2022)",
       .note =
           "Published as a learning problem, with the loss ‖y − y*‖² (loss=square). The default "
           "loss is half of it, so a step length of 2η here equals η there. mode=direct finds the "
           "controls (24 by default) of one initial state. Infinitely many controls lead back to "
           "this state, and the error in x is the distance from the nearest of them.",
       .aim = Aim::loss,  // any control that returns will do
       .family = "oscillators",
       .is_linear = true,
       .panels = panels_of("Learning curves")},
      make_linear_chain));
  registry.add(problem_entry(
      {.name = "coupled-oscillators",
       .title = "Coupled oscillators",
       .group = Group::physics,
       .formula = "ẍ₁ = −x₁ + (x₂ − x₁)³,  ẍ₂ = −x₂ − (x₂ − x₁)³ + 3u(t),  y* = the initial state",
       .source = "Schnell, Holl, Thuerey (2022), published scripts",
       .note =
           "Published as a learning problem, with the loss ‖y − y*‖² (loss=square). The default "
           "loss is half of it, so a step length of 2η here equals η there. mode=direct finds the "
           "controls (96 by default) of one initial state. The network is that of the scripts; "
           "that of the book has activation=tanh.",
       .aim = Aim::loss,  // any control that returns will do
       .family = "oscillators",
       .in_all = false,
       .panels = panels_of("Fig. 2b: learning curves")},
      make_coupled_oscillators));
}

}  // namespace isoline::problems
