// Muon, Jordan (2024), in the form of Liu and others (2025), arXiv 2502.16982, algorithm 1: for
// each matrix of weights, the momentum is brought near to its orthogonal factor UVᵀ by five steps
// of a Newton-Schulz iteration, X ← a X + b (XXᵀ) X + c (XXᵀ)² X from X = M/‖M‖, whose coefficients
// take every singular value to between 0.68 and 1.13 or so; W ← W − 0.2 η √max(rows, columns) X,
// which has the mean square of a step of Adam. Vectors are stepped by Adam at the same rate.
// Without weight decay.
#include <cmath>

#include "core/product.h"
#include "optimizers/matrix_blocks.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

constexpr Real kA = 3.4445, kB = -4.7750, kC = 2.0315;  // Jordan (2024)
constexpr int kNewtonSchulzSteps = 5;
constexpr Real kShareOfAdam = 0.2;  // root mean square of a step of Adam, in rates

struct Muon {
  Real rate = 1e-3, momentum = 0.95, beta1 = 0.9, beta2 = 0.999;

  struct Sheet {         // one matrix, rows ≤ columns, transposed where it is not
    Matrix X, next;      // (rows, columns)
    Matrix XX, squared;  // (rows, rows)
  };
  struct State {
    std::vector<MatrixBlock> blocks;
    std::vector<Sheet> sheets;
    Vector m, v;                  // (n), v of vectors alone
    Real power1 = 1, power2 = 1;  // β₁ᵗ, β₂ᵗ
    Linearization at;
    Vector gradient;  // (n)
  };
  static void persist(State& s, Archive& archive) { archive(s.m, s.v, s.power1, s.power2); }

  State init(Meter& f, const Vector& theta) const {
    State s;
    s.blocks = matrix_blocks(f.layout());
    s.sheets.resize(s.blocks.size());
    s.m = s.v = Vector::Zero(theta.size());
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    s.power1 *= beta1;
    s.power2 *= beta2;
    for (std::size_t i = 0; i < s.blocks.size(); ++i)
      s.blocks[i].is_matrix() ? step_matrix(s, i, theta) : step_vector(s, s.blocks[i], theta);
    return Status::running;
  }

  // M ← μ M + G, and X from G + μ M as Nesterov has it.
  void step_matrix(State& s, std::size_t i, Vector& theta) const {
    const MatrixBlock& block = s.blocks[i];
    Sheet& sheet = s.sheets[i];
    auto M = block.of(s.m);
    const auto G = block.of(s.gradient);
    M = momentum * M + G;
    const bool is_tall = block.rows > block.columns;
    if (is_tall)
      sheet.X = (G + momentum * M).transpose();
    else
      sheet.X = G + momentum * M;
    orthogonalize(sheet);
    const Real length =
        rate * kShareOfAdam * std::sqrt(static_cast<Real>(std::max(block.rows, block.columns)));
    if (is_tall)
      block.of(theta) -= length * sheet.X.transpose();
    else
      block.of(theta) -= length * sheet.X;
  }

  static void orthogonalize(Sheet& sheet) {
    const Index r = sheet.X.rows();
    const Real norm = sheet.X.norm();
    if (!(norm > 0)) return;
    sheet.X /= norm;
    sheet.XX.resize(r, r);
    sheet.squared.resize(r, r);
    for (int i = 0; i < kNewtonSchulzSteps; ++i) {
      product(Form::A_BH, sheet.X, sheet.X, sheet.XX);
      product(Form::A_B, sheet.XX, sheet.XX, sheet.squared);
      sheet.squared = kB * sheet.XX + kC * sheet.squared;
      sheet.next = kA * sheet.X;
      product(Form::A_B, sheet.squared, sheet.X, sheet.next, 1);
      std::swap(sheet.X, sheet.next);
    }
  }

  void step_vector(State& s, const MatrixBlock& block, Vector& theta) const {
    constexpr Real kEpsilon = 1e-8;
    const Index size = block.rows * block.columns;
    const Eigen::Map<const Eigen::ArrayXd> g(s.gradient.data() + block.offset, size);
    Eigen::Map<Eigen::ArrayXd> m(s.m.data() + block.offset, size);
    Eigen::Map<Eigen::ArrayXd> v(s.v.data() + block.offset, size);
    m = beta1 * m + (1 - beta1) * g;
    v = beta2 * v + (1 - beta2) * g.square();
    theta.segment(block.offset, size).array() -=
        rate / (1 - s.power1) * m / ((v / (1 - s.power2)).sqrt() + kEpsilon);
  }
};

void fields(Muon& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("momentum", o.momentum, between(0, 1), "share of the momentum that is kept, of matrices");
  field("beta1", o.beta1, decay(), "decay β₁ of the mean gradient, of vectors");
  field("beta2", o.beta2, decay(), "decay β₂ of the mean squared gradient, of vectors");
}

std::string objection(const OptionValues&, const Problem& problem) {
  return has_matrix(problem) ? "" : "muon needs a matrix of weights, and the problem has none";
}

}  // namespace

void register_muon(OptimizerRegistry& registry) {
  OptimizerEntry entry = stepper_entry<Muon>(
      {.name = "muon",
       .title = "Muon",
       .kind = Kind::adaptive,
       .formula = "M ← μ M + ∇L,  W ← W − 0.2 η √max(rows, columns) (M Mᵀ)^(−½) M",
       .source = "Jordan (2024); Liu and others (2025), algorithm 1",
       .note = "Five Newton-Schulz steps approximate the inverse root, so that singular values are "
               "only near 1. Adam updates vectors. Without weight decay.",
       .needs = {Oracle::forward, Oracle::pullback},
       .tunable = {.option = "rate", .below = 0},
       .objection = objection});
  registry.add(std::move(entry));
}

}  // namespace isoline::optimizers
