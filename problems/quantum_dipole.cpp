// A quantum particle in a box, steered by a field from the ground state to a superposition of the
// second and third state. Schnell, Holl, Thuerey (2022), published scripts. The particle's steps
// and their derivatives come first, then the problem.
#include <array>
#include <cmath>
#include <numbers>

#include "problems/learning.h"
#include "problems/particle_in_a_box.h"
#include "problems/sample_lanes.h"

namespace isoline::problems {
namespace {

constexpr Index kPoints = ParticleInABox::kPoints;
constexpr Real kDx = 2.0 / 15;

using State = LanesOf<2 * kPoints>;  // (re, im) of each point in turn

// A complex number of each lane, as two columns of a state.
struct Complex {
  Lanes re, im;
};
Complex at(const State& s, Index i) { return {s.col(2 * i), s.col(2 * i + 1)}; }
void put(const Complex& z, Index i, State& s) {
  s.col(2 * i) = z.re;
  s.col(2 * i + 1) = z.im;
}

Real position(Index i) { return kDx * static_cast<Real>(i + 1); }

// M of a control, factorized by elimination along the box: d_i its pivots, e = −iΔt/(2Δx²) beside
// the diagonal. Its conjugate where `sign` is −1.
class Factorized {
 public:
  Factorized(const Lanes& u, Real dt, Real sign) : off_(-sign * dt / (2 * kDx * kDx)) {
    Complex pivot;
    for (Index i = 0; i < kPoints; ++i) {
      pivot.im = sign * dt / 2 * (2 / (kDx * kDx) + u * position(i));
      pivot.re.setOnes();
      if (i > 0) {  // d_i = M_ii − e²/d_{i−1}, e² = −off²
        const Complex last = at(inverse_, i - 1);
        pivot.re += off_ * off_ * last.re;
        pivot.im += off_ * off_ * last.im;
      }
      const Lanes square = pivot.re.square() + pivot.im.square();
      put({pivot.re / square, -pivot.im / square}, i, inverse_);
    }
  }

  void solve(State& s) const {  // s ← M⁻¹ s
    for (Index i = 0; i < kPoints; ++i) {
      Complex z = at(s, i);
      if (i > 0) subtract_off(at(s, i - 1), z);  // s_{i−1} is over its pivot already
      const Complex d = at(inverse_, i);
      put({z.re * d.re - z.im * d.im, z.re * d.im + z.im * d.re}, i, s);
    }
    for (Index i = kPoints - 1; i-- > 0;) {  // s_i ← s_i − e s_{i+1}/d_i
      Complex away{Lanes::Zero(), Lanes::Zero()};
      subtract_off(at(s, i + 1), away);
      const Complex d = at(inverse_, i);
      s.col(2 * i) += away.re * d.re - away.im * d.im;
      s.col(2 * i + 1) += away.re * d.im + away.im * d.re;
    }
  }

 private:
  void subtract_off(const Complex& beside, Complex& z) const {  // z − e·beside, e = i·off
    z.re += off_ * beside.im;
    z.im -= off_ * beside.re;
  }

  Real off_;       // Im e
  State inverse_;  // 1/d_i
};

const State& ground_state() {
  static const State everywhere = [] {
    const Vector psi = ParticleInABox::eigenstate(1);
    State s;
    for (Index i = 0; i < kPoints; ++i) put({Lanes::Constant(psi[i]), Lanes::Zero()}, i, s);
    return s;
  }();
  return everywhere;
}

// The results of a forward pass: φ of each step, and scratch arrays.
struct Passes {
  Matrix &phis, &controls, &changes, &cotangents;  // (8, 28 T ⌈B/8⌉), (8, T), (8, T), (28, B)

  Passes(Workspace& w, Index steps, Index samples)
      : phis(sized(w)[0]), controls(w.saved[1]), changes(w.saved[2]), cotangents(w.saved[3]) {
    phis.resize(kLanes, 2 * kPoints * steps * groups_of_lanes(samples));
    controls.resize(kLanes, steps);
    changes.resize(kLanes, steps);
  }
  static std::vector<Matrix>& sized(Workspace& w) {
    w.saved.resize(4);
    return w.saved;
  }
  Eigen::Map<State> phi(Index group, Index step) const {
    return lanes_at<2 * kPoints>(phis, (group * controls.cols() + step) * 2 * kPoints);
  }
};

// s ← s − i length x ∘ φ
void add_field(const State& phi, const Lanes& length, State& s) {
  for (Index i = 0; i < kPoints; ++i) {
    const Lanes strength = length * position(i);
    s.col(2 * i) += strength * phi.col(2 * i + 1);
    s.col(2 * i + 1) -= strength * phi.col(2 * i);
  }
}

// Re⟨μ, −iΔt x ∘ φ⟩
Lanes along(const State& phi, const State& mu, Real dt) {
  Lanes sum = Lanes::Zero();
  for (Index i = 0; i < kPoints; ++i)
    sum += dt * position(i) *
           (mu.col(2 * i) * phi.col(2 * i + 1) - mu.col(2 * i + 1) * phi.col(2 * i));
  return sum;
}

// −iΔt νᵀ(x ∘ φ)
Complex derivative(const State& phi, const State& nu, Real dt) {
  Complex sum{Lanes::Zero(), Lanes::Zero()};
  for (Index i = 0; i < kPoints; ++i) {
    const Complex n = at(nu, i), p = at(phi, i);
    sum.re += dt * position(i) * (n.re * p.im + n.im * p.re);
    sum.im -= dt * position(i) * (n.re * p.re - n.im * p.im);
  }
  return sum;
}

}  // namespace

ComplexBatch complex_of(BatchRef y) {
  return {reinterpret_cast<const std::complex<Real>*>(y.data()), y.rows() / 2, y.cols(),
          Eigen::OuterStride<>(y.outerStride() / 2)};
}

ComplexBatchOut complex_in(BatchOut y) {
  return {reinterpret_cast<std::complex<Real>*>(y.data()), y.rows() / 2, y.cols(),
          Eigen::OuterStride<>(y.outerStride() / 2)};
}

Vector ParticleInABox::eigenstate(Index k) {
  const Real angle = std::numbers::pi * static_cast<Real>(k) / static_cast<Real>(kPoints + 1);
  return (angle * Vector::LinSpaced(kPoints, 1, kPoints)).array().sin().matrix().normalized();
}

void ParticleInABox::forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const {
  Passes passes(w, steps_, x.cols());
  by_lanes(x.cols(), [&](Index group, Index first, Index count) {
    gather(x, first, count, passes.controls);
    State psi = ground_state();
    for (Index t = 0; t < steps_; ++t) {
      State phi = psi;
      Factorized(lanes_at(passes.controls, t), dt_, 1).solve(phi);
      passes.phi(group, t) = phi;
      psi = 2 * phi - psi;
    }
    scatter(psi, first, count, y);
  });
  project(c, 1, y);
}

void ParticleInABox::pushforward(BatchRef v, BatchOut Jv, Workspace& w) const {
  Passes passes(w, steps_, v.cols());
  by_lanes(v.cols(), [&](Index group, Index first, Index count) {
    gather(w.x, first, count, passes.controls);
    gather(v, first, count, passes.changes);
    State dpsi = State::Zero();
    for (Index t = 0; t < steps_; ++t) {
      State dphi = dpsi;
      add_field(passes.phi(group, t), dt_ / 2 * lanes_at(passes.changes, t), dphi);
      Factorized(lanes_at(passes.controls, t), dt_, 1).solve(dphi);
      dpsi = 2 * dphi - dpsi;
    }
    scatter(dpsi, first, count, Jv);
  });
  project(w.context, 1, Jv);
}

void ParticleInABox::pullback(BatchRef u, BatchOut JTu, Workspace& w) const {
  Passes passes(w, steps_, u.cols());
  passes.cotangents = u;
  project(w.context, 1, passes.cotangents);
  by_lanes(u.cols(), [&](Index group, Index first, Index count) {
    gather(w.x, first, count, passes.controls);
    State lambda;
    gather(passes.cotangents, first, count, lambda);
    for (Index t = steps_; t-- > 0;) {
      State mu = lambda;
      Factorized(lanes_at(passes.controls, t), dt_, -1).solve(mu);
      lanes_at(passes.changes, t) = along(passes.phi(group, t), mu, dt_);
      lambda = 2 * mu - lambda;
    }
    scatter(passes.changes, first, count, JTu);
  });
}

// Rows, for what pulls ψ_j back is linear in complex numbers: one solve for both its parts. With
// ρ = e_j behind the last step, ∂ψ_j/∂u = −iΔt νᵀ(x ∘ φ), ν = M⁻¹ρ⁺, ρ = 2ν − ρ⁺; M is symmetric.
void ParticleInABox::jacobian(BatchOut J, Workspace& w) const {
  const Index samples = J.cols() / steps_;
  Passes passes(w, steps_, samples);
  std::array<State, kPoints> rho;
  by_lanes(samples, [&](Index group, Index first, Index count) {
    gather(w.x, first, count, passes.controls);
    for (Index j = 0; j < kPoints; ++j)
      put({Lanes::Ones(), Lanes::Zero()}, j, rho[j] = State::Zero());
    State phi, nu, derivatives;
    for (Index t = steps_; t-- > 0;) {
      const Factorized M(lanes_at(passes.controls, t), dt_, 1);
      phi = passes.phi(group, t);
      for (Index j = 0; j < kPoints; ++j) {
        nu = rho[j];
        M.solve(nu);
        put(derivative(phi, nu, dt_), j, derivatives);
        rho[j] = 2 * nu - rho[j];
      }
      for (Index b = 0; b < count; ++b)
        J.col((first + b) * steps_ + t) = derivatives.row(b).transpose().matrix();
    }
  });
  project(w.context, steps_, J);
}

// y ← (I − aaᵀ) y for `columns` of each sample
void ParticleInABox::project(BatchRef a, Index columns, BatchOut y) const {
  if (output_ == Output::state) return;
  ComplexBatchOut states = complex_in(y);
  for (Index i = 0; i < states.cols(); ++i) {
    const Index b = i / columns;
    const std::complex<Real> share = states.col(i).cwiseProduct(a.col(b)).sum();
    states.col(i) -= share * a.col(b);
  }
}

namespace {

struct Options {
  Index steps = ParticleInABox::kSteps;
  std::string loss;
  Index epoch = 1024;
  Learning learning{.network = "mlp[layers=20-20-20,activation=tanh,precision=double,init=glorot]",
                    .batch = 16};
};
void fields(Options& o, auto& field) {
  field("steps", o.steps, between(48, 3072),
        "number of time steps, each with one control; the total time is 19.2 for any number");
  field("loss", o.loss, {"", "residual"},
        "residual: y = (I − aaᵀ)ψ and y* = 0, the same loss as a sum of squares");
  field(kEpochOption, o.epoch, between(0, 1e6),
        "N: mode=learn takes the same N samples batch by batch, again and again; 0: new "
        "samples in each step");
  fields(o.learning, field);
}

// L = (1/B) Σ 1 − |⟨y*, y⟩|²
class Infidelity final : public Loss {
 public:
  bool is_least_squares() const override { return false; }
  Real value(BatchRef y, BatchRef target) const override {
    const ComplexBatch psi = complex_of(y), a = complex_of(target);
    Real sum = 0;
    for (Index b = 0; b < psi.cols(); ++b) sum += 1 - std::norm(a.col(b).dot(psi.col(b)));
    return sum / static_cast<Real>(psi.cols());
  }
  void cotangent(BatchRef y, BatchRef target, BatchOut g) const override {
    curvature(y, target, y, g);  // L is quadratic
  }
  void curvature(BatchRef, BatchRef target, BatchRef dy, BatchOut dg) const override {
    const ComplexBatch dpsi = complex_of(dy), a = complex_of(target);
    ComplexBatchOut out = complex_in(dg);
    const Real scale = -2 / static_cast<Real>(dpsi.cols());
    for (Index b = 0; b < dpsi.cols(); ++b)
      out.col(b) = scale * a.col(b).dot(dpsi.col(b)) * a.col(b);
  }
};

// a = f₁ψ₂ + f₂ψ₃, (f₁, f₂) a normalized pair of Gaussians. It is real: the published scripts
// sample phases but do not use them.
Vector superposition(RandomStream& stream) {
  const Eigen::Vector2d f = stream.normal_vector(2).normalized();
  return f[0] * ParticleInABox::eigenstate(2) + f[1] * ParticleInABox::eigenstate(3);
}

Vector interleaved(const Vector& a) {
  Vector state = Vector::Zero(2 * kPoints);
  for (Index i = 0; i < kPoints; ++i) state[2 * i] = a[i];
  return state;
}

constexpr Real kRounding = 1e-12;  // of 1 − |⟨a, ψ⟩|², as ‖ψ‖ is kept to it over all steps

ProblemParts make_quantum_dipole(const Options& o, const Draw& draw) {
  const bool is_residual = o.loss == "residual";
  ProblemParts parts;
  if (!o.learning.is_on()) {
    // The standard start of one problem is u = 1, not 0: there ψ keeps to ψ₁, which is orthogonal
    // to every target, and the gradient of the loss vanishes.
    RandomStream stream = draw.stream("target");
    const Vector a = superposition(stream);
    parts = {.start = draw.start(Vector::Ones(o.steps)),
             .target = interleaved(a),
             .minimum = 0,
             .minimum_error = kRounding};
    if (is_residual) {
      parts.context = a;
      parts.target.setZero();
    }
  }
  parts.physics = std::make_unique<ParticleInABox>(
      is_residual ? ParticleInABox::Output::missing : ParticleInABox::Output::state, o.steps);
  if (is_residual)
    parts.loss = std::make_unique<HalfSquared>(2);
  else
    parts.loss = std::make_unique<Infidelity>();
  if (!o.learning.is_on()) return parts;
  parts.samples = {.epoch = o.epoch,
                   .contexts = is_residual ? kPoints : 0,
                   .has_truth = false,
                   .draw = [is_residual](RandomStream& stream, Index b, Batch& batch) {
                     const Vector a = superposition(stream);
                     batch.input.col(b) = batch.target.col(b) = interleaved(a);
                     if (!is_residual) return;
                     batch.context.col(b) = a;
                     batch.target.col(b).setZero();
                   }};
  parts = learn(o.learning, {.inputs = 2 * kPoints, .outputs = o.steps}, draw, std::move(parts));
  add_neurons(parts);
  return parts;
}

}  // namespace

void register_quantum_dipole(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "quantum-dipole",
       .title = "Quantum dipole",
       .group = Group::physics,
       .formula = "iψ̇ = (−∂² + u(t) x) ψ on [0, 2],  ψ(0) = ψ₁,  L = 1 − |⟨a, ψ(T)⟩|²,  "
                  "a = f₁ψ₂ + f₂ψ₃",
       .source = "Schnell, Holl, Thuerey (2022), published scripts",
       .note =
           "Published as a learning problem. mode=direct finds the controls (384 by default) of "
           "one target, from u = 1, since the gradient vanishes at u = 0. loss=residual has the "
           "same loss as the sum of squares ‖(I − aaᵀ)ψ‖², which least-squares methods can use. "
           "The targets are real, as published: the phases that the scripts sample are not used.",
       .aim = Aim::loss,  // any control that arrives will do
       .in_all = false,
       .panels =
           {{.title = "Learning curves", .kind = "curve"},
            {.title = "Saturated neurons", .kind = "series", .quantity = "saturated neurons"}}},
      make_quantum_dipole));
}

}  // namespace isoline::problems
