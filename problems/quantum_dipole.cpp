// A quantum particle in a box, steered by a field from the ground state to a superposition of the
// second and third state. Schnell, Holl, Thuerey (2022), published scripts.
#include <cmath>

#include "problems/learning.h"
#include "problems/particle_in_a_box.h"

namespace isoline::problems {
namespace {

constexpr Index kPoints = ParticleInABox::kPoints, kSteps = ParticleInABox::kSteps;

struct Options {
  std::string loss;
  Index epoch = 1024;
  Learning learning{.network = "mlp[layers=20-20-20,activation=tanh,precision=double,init=glorot]",
                    .batch = 16};
};
void fields(Options& o, auto& field) {
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

// The standard start of one problem is u = 1, not 0: there ψ keeps to ψ₁, which is orthogonal to
// every target, and the gradient of the loss vanishes.
ProblemParts one_target(const Options& o, const Draw& draw) {
  RandomStream stream = draw.stream("target");
  const Vector a = superposition(stream);
  ProblemParts parts{.start = draw.start(Vector::Ones(kSteps)),
                     .target = interleaved(a),
                     .minimum = 0,
                     .minimum_error = kRounding};
  if (o.loss == "residual") {
    parts.context = a;
    parts.target.setZero();
  }
  return parts;
}

ProblemParts make_quantum_dipole(const Options& o, const Draw& draw) {
  const bool is_residual = o.loss == "residual";
  ProblemParts parts = o.learning.is_on() ? ProblemParts{} : one_target(o, draw);
  parts.physics = std::make_unique<ParticleInABox>(is_residual ? ParticleInABox::Output::missing
                                                               : ParticleInABox::Output::state);
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
  parts = learn(o.learning, {.inputs = 2 * kPoints, .outputs = kSteps}, draw, std::move(parts));
  const Network& network = *parts.network;
  parts.series = joined(std::move(parts.series),
                        joined(hidden_activity(network), saturation(network, /*shown=*/0)));
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
           "Published as a learning problem. mode=direct finds the 384 controls of one target, "
           "from u = 1, since the gradient vanishes at u = 0. loss=residual has the same loss as "
           "the sum of squares ‖(I − aaᵀ)ψ‖², which least-squares methods can use. The targets "
           "are real, as published: the phases that the scripts sample are "
           "not used.",
       .aim = Aim::loss,  // any control that arrives will do
       .in_all = false,
       .panels =
           {{.title = "Learning curves", .kind = "curve"},
            {.title = "Saturated neurons", .kind = "series", .quantity = "saturated neurons"}}},
      make_quantum_dipole));
}

}  // namespace isoline::problems
