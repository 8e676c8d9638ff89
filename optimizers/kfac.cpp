// Kronecker-factored curvature, Martens, Grosse (2015): with ā = (a, 1) the input of a dense layer
// and g the cotangent of its output, the layer's block of the Gauss-Newton matrix is taken as A ⊗ G
// with A = ⟨ā āᵀ⟩ and G = ⟨g gᵀ⟩, so that [W b] ← [W b] − η (G + √λ/π I)⁻¹ ∇L (A + π√λ I)⁻¹ with π²
// = (tr A/dim A)/(tr G/dim G). Of a convolution, Grosse, Martens (2016): A = ⟨Σ_t ā āᵀ⟩ over the
// patches ā at all places t, G = ⟨g gᵀ⟩ over samples and places, as if the cotangents of different
// places were uncorrelated and alike; where the physics correlates them the curvature is larger, by
// up to the number of places, and the rate must be smaller. g is that of √(∂²ℓ/∂yᵢ²) eᵢ, ℓ a
// sample's loss, for each output i in turn, so that G is exact; of a convolution, or of more than
// 64 outputs, that of all outputs at once with random signs, one sample per step. Of a network that
// carries derivatives in lanes, A is the mean and G the sum over the lanes of a sample; Dangel,
// Müller, Zeinhofer (2024), arXiv 2405.15603. Of the loss's
// curvature the diagonal is used, which for ½‖y − y*‖² is all of it. Batch norm's γ and β have no
// such form: each steps along its gradient, over λ and the mean of its curvature's diagonal under
// the same signs. Running means as the paper's; its rescaling by the exact Gauss-Newton matrix,
// momentum and adaptive λ are left out.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/decompose.h"
#include "optimizers/matrix_blocks.h"
#include "optimizers/meter.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

class KroneckerBlock {
 public:
  Matrix A, G;  // (columns + 1)² and (rows)² of [W b], lower halves

  // Shrinks the running means by `kept`, to which are then added: of a dense layer, its inputs a,
  // (columns, B) or (columns, lanes·B), as ā āᵀ, or outer products made elsewhere.
  void fade(Real kept, Index inputs, Index outputs) {
    if (A.size() == 0) {
      A.setZero(inputs, inputs);
      G.setZero(outputs, outputs);
    }
    A *= kept;
    G *= kept;
  }
  void add_inputs(const Matrix& a, Index samples, Real share) {
    a_.setZero(a.rows() + 1, a.cols());
    a_.topRows(a.rows()) = a;
    a_.bottomRows<1>().head(samples).setOnes();
    A.selfadjointView<Eigen::Lower>().rankUpdate(a_, share);
  }

  // ∇L of the layer's two blocks through the inverse; false where a factor is not positive
  // definite.
  bool precondition(const Block& W, const Block& b, Vector& gradient, Real damping) {
    step_.resize(b.rows, A.rows());
    step_ << kernel(W, b, gradient), gradient.segment(b.offset, b.rows);
    const Real mean_A = A.diagonal().mean(), mean_G = G.diagonal().mean();
    const Real pi = mean_A > 0 && mean_G > 0 ? std::sqrt(mean_A / mean_G) : 1;
    damped_A_ = A;
    damped_A_.diagonal().array() += pi * std::sqrt(damping);
    damped_G_ = G;
    damped_G_.diagonal().array() += std::sqrt(damping) / pi;
    if (!solve_positive_definite(damped_G_, step_)) return false;
    turned_ = step_.transpose();
    return solve_positive_definite(damped_A_, turned_);
  }
  void step(const Block& W, const Block& b, Real rate, Vector& theta) const {
    kernel(W, b, theta) -= rate * turned_.topRows(turned_.rows() - 1).transpose();
    theta.segment(b.offset, b.rows) -= rate * turned_.bottomRows(1).transpose();
  }

 private:
  using Stride = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
  using Kernel = Eigen::Map<Matrix, Eigen::Unaligned, Stride>;

  // W, one row for each output. A dense layer's lies in θ column by column, and a convolution's row
  // by row.
  static Kernel kernel(const Block& W, const Block& b, Vector& theta) {
    const Index columns = W.rows * W.columns / b.rows;
    const bool is_dense = W.kind == Block::Kind::weight;
    const Stride stride = is_dense ? Stride(b.rows, 1) : Stride(1, columns);
    return {theta.data() + W.offset, b.rows, columns, stride};
  }

  Matrix a_;       // ā, (columns + 1, B)
  Matrix step_;    // (rows, columns + 1), of [W b]
  Matrix turned_;  // (columns + 1, rows), its transpose
  Matrix damped_A_, damped_G_;
};

constexpr Index kMostExact = 64;  // outputs, each of which costs a pullback

struct Kfac {
  Real rate = 1e-3, damping = 1e-3, decay = 0.95;

  struct State {
    std::uint64_t steps = 0;
    std::vector<KroneckerBlock> layers;
    std::vector<Block> blocks, norms;
    Vector curvatures;  // of norms: running means of their diagonals' means
    std::vector<LayerFactor> factors;
    std::vector<LayerMoments> moments;
    Linearization at;
    Matrix unit, cotangent;  // (m, B)
    Vector gradient, drawn;  // (n) ∇L, and Jᵀ of a random cotangent
  };
  static void persist(State& s, Archive& archive) {
    std::size_t layers = s.layers.size();
    archive(s.steps, s.curvatures, layers);
    s.layers.resize(layers);
    for (KroneckerBlock& layer : s.layers) archive(layer.A, layer.G);
  }

  State init(Meter& f, const Vector& theta) const {
    State s;
    s.blocks = f.layout();
    for (const Block& block : s.blocks)
      if (block.kind == Block::Kind::norm) s.norms.push_back(block);
    s.curvatures = Vector::Zero(static_cast<Index>(s.norms.size()));
    s.unit.setZero(f.target().rows(), f.target().cols());
    s.cotangent = s.unit;
    s.drawn.resize(theta.size());
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    const bool is_dense = f.is_granted(Oracle::layer_factors);
    is_dense ? observe_layers(s) : observe_convolutions(s);
    for (std::size_t l = 0; l < s.layers.size(); ++l) {
      const Index weight = is_dense ? s.factors[l].weight : s.moments[l].weight;
      const Index bias = is_dense ? s.factors[l].bias : s.moments[l].bias;
      KroneckerBlock& layer = s.layers[l];
      if (!layer.precondition(s.blocks[weight], s.blocks[bias], s.gradient, damping)) {
        f.claim("a factor of the curvature is not positive definite in finite numbers");
        return Status::stalled;
      }
      layer.step(s.blocks[weight], s.blocks[bias], rate, theta);
    }
    for (std::size_t i = 0; i < s.norms.size(); ++i)
      theta.segment(s.norms[i].offset, s.norms[i].rows) -=
          rate / (s.curvatures[static_cast<Index>(i)] + damping) *
          s.gradient.segment(s.norms[i].offset, s.norms[i].rows);
    return Status::running;
  }

  // The share of the running means that is kept, min(1 − 1/t, decay).
  Real keep(State& s) const { return std::min(1 - 1 / static_cast<Real>(++s.steps), decay); }

  // √(∂²ℓ/∂y²) times `unit`, whose entries are 0, 1 and −1.
  static void weigh(State& s) {
    const Real samples = static_cast<Real>(s.unit.cols());
    s.at.loss_curvature(s.unit, s.cotangent);
    s.cotangent.array() *= s.unit.array();
    s.cotangent.array() = (samples * s.cotangent.array().max(0)).sqrt() * s.unit.array();
  }
  // By the number of the step, so that a run that goes on sees the signs it would have seen.
  static void draw(State& s) {
    Eigen::Map<Vector> unit(s.unit.data(), s.unit.size());
    RandomStream(0, "kfac", "probe", s.steps).signs(unit);
    weigh(s);
  }

  // The means of this batch into the running ones.
  void observe_layers(State& s) const {
    const Real kept = keep(s), share = (1 - kept) / static_cast<Real>(s.unit.cols());
    const bool is_exact = s.unit.rows() <= kMostExact;
    for (Index i = 0; i < (is_exact ? s.unit.rows() : 1); ++i) {
      if (is_exact) {
        s.unit.row(i).setOnes();
        weigh(s);
        s.unit.row(i).setZero();
      } else {
        draw(s);
      }
      s.at.layer_factors(s.cotangent, s.factors);
      s.layers.resize(s.factors.size());
      for (std::size_t l = 0; l < s.layers.size(); ++l) {
        KroneckerBlock& layer = s.layers[l];
        const Matrix &inputs = s.factors[l].inputs, &cotangents = s.factors[l].cotangents;
        if (i == 0) {
          layer.fade(kept, inputs.rows() + 1, cotangents.rows());
          layer.add_inputs(inputs, s.unit.cols(), (1 - kept) / static_cast<Real>(inputs.cols()));
        }
        layer.G.selfadjointView<Eigen::Lower>().rankUpdate(cotangents, share);
      }
    }
  }

  void observe_convolutions(State& s) const {
    const Real kept = keep(s);
    draw(s);
    s.at.layer_moments(s.cotangent, s.moments, s.drawn);
    s.layers.resize(s.moments.size());
    for (std::size_t l = 0; l < s.layers.size(); ++l) {
      KroneckerBlock& layer = s.layers[l];
      layer.fade(kept, s.moments[l].inputs.rows(), s.moments[l].cotangents.rows());
      layer.A += (1 - kept) * s.moments[l].inputs;
      layer.G += (1 - kept) * s.moments[l].cotangents;
    }
    s.curvatures *= kept;
    const Real share = (1 - kept) / static_cast<Real>(s.unit.cols());
    for (std::size_t i = 0; i < s.norms.size(); ++i)
      s.curvatures[static_cast<Index>(i)] +=
          share * s.drawn.segment(s.norms[i].offset, s.norms[i].rows).array().square().mean();
  }
};

void fields(Kfac& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("damping", o.damping, above(0), "damping λ");
  field("decay", o.decay, between(0, 1), "largest share of the running means that is kept");
}

// The factors of dense layers if there are any, otherwise sums over places.
OracleSet needs(const OptionValues&, const Problem& problem) {
  const bool is_dense = problem.offers().contains(Oracle::layer_factors);
  return {Oracle::forward, Oracle::pullback,
          is_dense ? Oracle::layer_factors : Oracle::layer_moments};
}

std::string objection(const OptionValues&, const Problem& problem) {
  constexpr Index kLongest = 4096;  // of which a Cholesky factorization takes a second
  Index longest = 0;
  for (const MatrixBlock& block : matrix_blocks(problem.layout()))
    longest = std::max({longest, block.rows, block.columns});
  if (longest <= kLongest) return "";
  return fmt::format("a layer of {} inputs or outputs, and kfac is limited to {}", longest,
                     kLongest);
}

}  // namespace

void register_kfac(OptimizerRegistry& registry) {
  registry.add(stepper_entry<Kfac>(
      {.name = "kfac",
       .title = "Kronecker-factored curvature",
       .family = Family::curvature,
       .kind = Kind::second_order,
       .formula = "[W b] ← [W b] − η (G + √λ/π I)⁻¹ ∇L (A + π√λ I)⁻¹,  A = ⟨ā āᵀ⟩, G = ⟨g gᵀ⟩",
       .source = "Martens, Grosse (2015); of convolutions Grosse, Martens (2016)",
       .note =
           "For networks of dense layers or of convolutions. G is exact, with one pullback per "
           "output. For convolutions, and for more than 64 outputs, it uses one random cotangent "
           "per step, the same for every seed. A convolution's A is the sum over places, its G the "
           "mean: this underestimates the curvature if the physics correlates places. Batch norm's "
           "γ and β step along their gradients, over the mean of their curvature's diagonal. "
           "Without the paper's rescaling, momentum and adaptive damping.",
       .needs = {Oracle::forward, Oracle::pullback},
       .tunable = {.option = "rate", .below = 1},
       .needs_for = needs,
       .objection = objection}));
}

}  // namespace isoline::optimizers
