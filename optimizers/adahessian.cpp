// AdaHessian, Yao et al. (2021): Adam with the diagonal of the Hessian in place of the gradient in
// v. D = z ⊙ ∇²L z, z of random signs (Hutchinson), one probe per step; m ← β₁ m + (1 − β₁) ∇L, v ←
// β₂ v + (1 − β₂) D², θ ← θ − η m̂/(√v̂ᵖ + ε). As in torch_optimizer, the absolute values |D| of a
// convolution's taps are averaged for each pair of channels, so also those of the modes of a
// Fourier layer, and p is ½ where the paper has 1.
#include <cmath>

#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct AdaHessian {
  Real rate = 0.15, beta1 = 0.9, beta2 = 0.999, epsilon = 1e-4, power = 0.5;
  bool averages = true;

  struct State {
    std::vector<Block> kernels;
    Vector m, v;                  // (n)
    Real power1 = 1, power2 = 1;  // β₁ᵗ, β₂ᵗ
    std::uint64_t steps = 0;
    Linearization at;
    Vector gradient, probe, diagonal;  // (n) ∇L, z, D
  };
  static void persist(State& s, Archive& archive) {
    archive(s.m, s.v, s.power1, s.power2, s.steps);
  }

  State init(Meter& f, const Vector& theta) const {
    State s;
    s.m = s.v = s.probe = s.diagonal = Vector::Zero(theta.size());
    for (const Block& block : f.layout())
      if (averages &&
          (block.kind == Block::Kind::convolution || block.kind == Block::Kind::spectrum))
        s.kernels.push_back(block);
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    // By the number of the step, so that a run that goes on sees the probes it would have seen.
    RandomStream(0, "adahessian", "probe", s.steps++).signs(s.probe);
    s.at.hessian_product(s.probe, s.diagonal);
    s.diagonal.array() *= s.probe.array();
    for (const Block& kernel : s.kernels) average(kernel, s.diagonal);
    s.m = beta1 * s.m + (1 - beta1) * s.gradient;
    s.v = beta2 * s.v + (1 - beta2) * s.diagonal.cwiseAbs2();
    s.power1 *= beta1;
    s.power2 *= beta2;
    s.diagonal = (s.v / (1 - s.power2)).cwiseSqrt();
    const Real eta = rate / (1 - s.power1);
    if (power == 0.5)  // two roots cost a tenth of a power
      theta.array() -= eta * s.m.array() / (s.diagonal.array().sqrt() + epsilon);
    else
      theta.array() -= eta * s.m.array() / (s.diagonal.array().pow(power) + epsilon);
    return Status::running;
  }

  // All that belongs to one pair of channels: a column of taps, or two rows of modes.
  static void average(const Block& kernel, Vector& diagonal) {
    Eigen::Map<Matrix> D(diagonal.data() + kernel.offset, kernel.rows, kernel.columns);
    if (kernel.kind == Block::Kind::convolution)
      for (Index j = 0; j < D.cols(); ++j) D.col(j).setConstant(D.col(j).cwiseAbs().mean());
    else
      for (Index i = 0; i < D.rows(); i += 2)
        D.middleRows(i, 2).setConstant(D.middleRows(i, 2).cwiseAbs().mean());
  }
};

void fields(AdaHessian& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("beta1", o.beta1, decay(), "decay β₁ of the mean gradient");
  field("beta2", o.beta2, decay(), "decay β₂ of the mean squared diagonal");
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
  field("power", o.power, between(0, 1), "power p of the diagonal; the paper's Hessian power");
  field("average", o.averages,
        "whether |D| is averaged over the taps or modes of a pair of channels");
}

}  // namespace

void register_adahessian(OptimizerRegistry& registry) {
  registry.add(stepper_entry<AdaHessian>(
      {.name = "adahessian",
       .title = "AdaHessian",
       .family = Family::curvature,
       .kind = Kind::second_order,
       .formula = "D = z ⊙ ∇²L z,  m ← β₁ m + (1−β₁) ∇L,  v ← β₂ v + (1−β₂) D²,  "
                  "θ ← θ − η m̂/(√v̂ᵖ + ε)",
       .source = "Yao et al. (2021)",
       .note = "The defaults are those of torch_optimizer, including p = ½; the paper has p = 1. "
               "Products with the Hessian are exact. The probes are the same for every seed.",
       .needs = {Oracle::forward, Oracle::pullback, Oracle::hessian_product},
       .tunable = {.option = "rate"}}));
}

}  // namespace isoline::optimizers
