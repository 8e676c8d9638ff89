// Kronecker-factored curvature, Martens, Grosse (2015): with ā = (a, 1) the input of a dense layer
// and g the cotangent of its output, the layer's block of the Gauss-Newton matrix is taken as A ⊗ G
// with A = ⟨ā āᵀ⟩ and G = ⟨g gᵀ⟩, so that [W b] ← [W b] − η (G + √λ/π I)⁻¹ ∇L (A + π√λ I)⁻¹ with π²
// = (tr A/dim A)/(tr G/dim G). G is exact, not sampled: the sum over the outputs i of the
// cotangents √(∂²ℓ/∂yᵢ²) eᵢ, ℓ a sample's loss. Of the loss's curvature the diagonal is used, which
// for ½‖y − y*‖² is all of it. Running means as the paper's; its rescaling by the exact
// Gauss-Newton matrix, momentum and adaptive λ are left out.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Kfac {
  Real rate = 1e-3, damping = 1e-3, decay = 0.95;

  struct Layer {
    Matrix A, G;    // running means, (columns + 1)² and (rows)²
    Matrix a;       // ā, (columns + 1, B)
    Matrix step;    // (rows, columns + 1), of [W b]
    Matrix turned;  // (columns + 1, rows), its transpose
    Matrix damped_A, damped_G;
  };
  struct State {
    std::uint64_t steps = 0;
    std::vector<Layer> layers;
    std::vector<Block> blocks;
    std::vector<LayerFactor> factors;
    Linearization at;
    Matrix unit, cotangent;  // (m, B)
    Vector gradient;         // (n)
  };
  static void persist(State& s, Archive& archive) {
    std::size_t layers = s.layers.size();
    archive(s.steps, layers);
    s.layers.resize(layers);
    for (Layer& layer : s.layers) archive(layer.A, layer.G);
  }

  State init(Meter& f, const Vector&) const {
    State s;
    s.blocks = f.layout();
    s.unit.setZero(f.target().rows(), f.target().cols());
    s.cotangent = s.unit;
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    observe(s);
    for (std::size_t l = 0; l < s.layers.size(); ++l) {
      const Block &W = s.blocks[s.factors[l].weight], &b = s.blocks[s.factors[l].bias];
      Layer& layer = s.layers[l];
      layer.step.resize(W.rows, W.columns + 1);
      layer.step << Eigen::Map<Matrix>(s.gradient.data() + W.offset, W.rows, W.columns),
          s.gradient.segment(b.offset, W.rows);
      if (!precondition(layer)) {
        f.claim("a factor of the curvature is not positive definite in finite numbers");
        return Status::stalled;
      }
      Eigen::Map<Matrix>(theta.data() + W.offset, W.rows, W.columns) -=
          rate * layer.turned.topRows(W.columns).transpose();
      theta.segment(b.offset, W.rows) -= rate * layer.turned.row(W.columns).transpose();
    }
    return Status::running;
  }

  // The means of this batch into the running ones, whose share is min(1 − 1/t, decay).
  void observe(State& s) const {
    const Real keep = std::min(1 - 1 / static_cast<Real>(++s.steps), decay);
    const Real samples = static_cast<Real>(s.unit.cols()), share = (1 - keep) / samples;
    for (Index i = 0; i < s.unit.rows(); ++i) {
      s.unit.row(i).setOnes();
      s.at.loss_curvature(s.unit, s.cotangent);
      s.cotangent.array() = (samples * s.cotangent.array().max(0)).sqrt() * s.unit.array();
      s.unit.row(i).setZero();
      s.at.layer_factors(s.cotangent, s.factors);
      s.layers.resize(s.factors.size());
      for (std::size_t l = 0; l < s.layers.size(); ++l) {
        Layer& layer = s.layers[l];
        const Matrix &inputs = s.factors[l].inputs, &cotangents = s.factors[l].cotangents;
        if (layer.A.size() == 0) {
          layer.A.setZero(inputs.rows() + 1, inputs.rows() + 1);
          layer.G.setZero(cotangents.rows(), cotangents.rows());
        }
        if (i == 0) {
          layer.a.setOnes(inputs.rows() + 1, inputs.cols());
          layer.a.topRows(inputs.rows()) = inputs;
          layer.A *= keep;
          layer.A.selfadjointView<Eigen::Lower>().rankUpdate(layer.a, share);
          layer.G *= keep;
        }
        layer.G.selfadjointView<Eigen::Lower>().rankUpdate(cotangents, share);
      }
    }
  }

  // turned = ((G + √λ/π I)⁻¹ step (A + π√λ I)⁻¹)ᵀ
  bool precondition(Layer& layer) const {
    const Real mean_A = layer.A.diagonal().mean(), mean_G = layer.G.diagonal().mean();
    const Real pi = mean_A > 0 && mean_G > 0 ? std::sqrt(mean_A / mean_G) : 1;
    layer.damped_A = layer.A;
    layer.damped_A.diagonal().array() += pi * std::sqrt(damping);
    layer.damped_G = layer.G;
    layer.damped_G.diagonal().array() += std::sqrt(damping) / pi;
    if (!solve_positive_definite(layer.damped_G, layer.step)) return false;
    layer.turned = layer.step.transpose();
    return solve_positive_definite(layer.damped_A, layer.turned);
  }
};

void fields(Kfac& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("damping", o.damping, above(0), "damping λ");
  field("decay", o.decay, between(0, 1), "largest share of the running means that is kept");
}

std::string objection(const OptionValues&, const Problem& problem) {
  constexpr Index kMostOutputs = 64;
  if (problem.outputs() <= kMostOutputs) return "";
  return fmt::format("a pullback for each of {} outputs, and kfac is limited to {}",
                     problem.outputs(), kMostOutputs);
}

}  // namespace

void register_kfac(OptimizerRegistry& registry) {
  registry.add(stepper_entry<Kfac>(
      {.name = "kfac",
       .title = "Kronecker-factored curvature",
       .family = Family::curvature,
       .kind = Kind::second_order,
       .formula = "[W b] ← [W b] − η (G + √λ/π I)⁻¹ ∇L (A + π√λ I)⁻¹,  A = ⟨ā āᵀ⟩, G = ⟨g gᵀ⟩",
       .source = "Martens, Grosse (2015)",
       .note = "For networks of dense layers. G is exact, by one pullback for each output; without "
               "the paper's rescaling, momentum and adaptive damping.",
       .needs = {Oracle::forward, Oracle::pullback, Oracle::layer_factors},
       .tunable = {.option = "rate", .below = 1},
       .objection = objection}));
}

}  // namespace isoline::optimizers
