// Methods that treat the weights of a layer as one matrix.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/decompose.h"
#include "core/product.h"
#include "optimizers/matrix_blocks.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

auto objection_without_matrix(const char* name) {
  return [name](const OptionValues&, const Problem& problem) -> std::string {
    const auto blocks = matrix_blocks(problem.layout());
    if (std::ranges::any_of(blocks, &MatrixBlock::is_matrix)) return "";
    return fmt::format("{} needs a matrix of weights, and the problem has none", name);
  };
}

// Muon, Jordan (2024), in the form of Liu and others (2025), arXiv 2502.16982, algorithm 1: for
// each matrix of weights, the momentum is brought near to its orthogonal factor UVᵀ by five steps
// of a Newton-Schulz iteration, X ← a X + b (XXᵀ) X + c (XXᵀ)² X from X = M/‖M‖, whose coefficients
// take every singular value to between 0.68 and 1.13 or so; W ← W − 0.2 η √max(rows, columns) X,
// which has the mean square of a step of Adam. Vectors are stepped by Adam at the same rate.
// Without weight decay.
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
    const Real norm = sheet.X.norm();
    if (!(norm > 0)) return;
    sheet.X /= norm;
    for (Matrix* square : {&sheet.XX, &sheet.squared})
      square->resize(sheet.X.rows(), sheet.X.rows());
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

// One side of a matrix.
struct Side {
  bool is_used = false;
  Matrix sum = {}, root = {};  // (side, side): L or R; its negative power, or its eigenvectors

  Side() = default;
  Side(bool uses, Index size, Real diagonal) : is_used(uses) {
    if (uses) sum = diagonal * Matrix::Identity(size, size);
  }
  void turn(Form form, bool is_left, Matrix& G, Matrix& room) const {
    if (!is_used) return;
    room.resize(G.rows(), G.cols());
    is_left ? product(form, root, G, room) : product(form, G, root, room);
    std::swap(G, room);
  }
};

// Shampoo, Gupta, Koren, Singer (2018), algorithm 1: of each matrix of weights with gradient G,
// L ← L + G Gᵀ, R ← R + Gᵀ G, W ← W − η L^(−¼) G R^(−¼), from L = R = ε I; of a vector L^(−½) g,
// which is AdaGrad with its full matrix. A side longer than a limit is left alone, and the other's
// exponent is then −½. The roots can be renewed every few steps only; but a root of a few gradients
// is vast where they have not been, and one that is kept too long makes the next step diverge.
struct Shampoo {
  Real rate = 0.1, epsilon = 1e-4;
  Index every = 1, longest = 512;

  struct Sheet {
    Side left, right;
    Matrix G, step;  // (rows, columns)
  };
  struct State {
    std::uint64_t steps = 0;
    std::vector<MatrixBlock> blocks;
    std::vector<Sheet> sheets;
    SymmetricEigen eigen;
    Matrix scaled;  // of eigenvectors
    Linearization at;
    Vector gradient;  // (n)
  };
  static void persist(State& s, Archive& archive) {
    archive(s.steps);
    for (Sheet& sheet : s.sheets)
      archive(sheet.left.sum, sheet.left.root, sheet.right.sum, sheet.right.root);
  }

  State init(Meter& f, const Vector&) const {
    State s;
    s.blocks = matrix_blocks(f.layout());
    for (const MatrixBlock& block : s.blocks) {
      const bool has_right = 1 < block.columns && block.columns <= longest;
      s.sheets.push_back({.left = Side(block.rows <= longest, block.rows, epsilon),
                          .right = Side(has_right, block.columns, epsilon)});
    }
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    const bool renews = s.steps++ % static_cast<std::uint64_t>(every) == 0;
    for (std::size_t i = 0; i < s.blocks.size(); ++i) {
      Sheet& sheet = s.sheets[i];
      sheet.G = s.blocks[i].of(s.gradient);
      if (sheet.left.is_used) product(Form::A_BH, sheet.G, sheet.G, sheet.left.sum, 1);
      if (sheet.right.is_used) product(Form::AH_B, sheet.G, sheet.G, sheet.right.sum, 1);
      if (renews && !renew(sheet, s)) {
        f.claim("a preconditioner has no eigenvalues in finite numbers");
        return Status::stalled;
      }
      precondition(sheet);
      s.blocks[i].of(theta) -= rate * sheet.G;
    }
    return Status::running;
  }

  // A sum is at least ε in every direction, whatever rounding makes of a large one.
  bool renew(Sheet& sheet, State& s) const {
    const int sides = sheet.left.is_used + sheet.right.is_used;
    for (Side* side : {&sheet.left, &sheet.right}) {
      if (!side->is_used) continue;
      if (!symmetric_eigen(side->sum, s.eigen)) return false;
      const Vector powers = s.eigen.lambda.array().max(epsilon).pow(-0.5 / sides).matrix();
      s.scaled = s.eigen.V * powers.asDiagonal();
      side->root.resize(s.scaled.rows(), s.scaled.rows());
      product(Form::A_BH, s.scaled, s.eigen.V, side->root);
    }
    return true;
  }

  // G ← L^p G R^p
  static void precondition(Sheet& sheet) {
    sheet.left.turn(Form::A_B, true, sheet.G, sheet.step);
    sheet.right.turn(Form::A_B, false, sheet.G, sheet.step);
  }
};

void fields(Shampoo& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("epsilon", o.epsilon, above(0), "ε of the sums at the start");
  field("every", o.every, between(1, 1e6), "steps from one renewal of the roots to the next");
  field("longest", o.longest, between(1, 4096), "longest side that has a preconditioner");
}

std::string objection_of_shampoo(const OptionValues& options, const Problem& problem) {
  const auto longest = static_cast<Index>(options.number("longest", 0));
  for (const MatrixBlock& block : matrix_blocks(problem.layout()))
    if (std::min(block.rows, block.columns > 1 ? block.columns : block.rows) <= longest) return "";
  return fmt::format("no side of its unknowns has a length up to {}", longest);
}

// SOAP, Vyas and others (2024), arXiv 2409.11321, algorithm 3: Adam in the eigenbasis of Shampoo's
// preconditioner. Of each matrix of weights with gradient G, L ← β₂ L + (1 − β₂) G Gᵀ and
// R ← β₂ R + (1 − β₂) Gᵀ G have the eigenvectors Q_L and Q_R; G' = Q_Lᵀ G Q_R, M' = Q_Lᵀ M Q_R,
// V ← β₂ V + (1 − β₂) G'², W ← W − η Q_L (M̂'/(√V̂ + ε)) Q_Rᵀ. As in the authors' code the first step
// only fills L and R, and the basis is renewed after an update, every few steps; here by all
// eigenvectors instead of one step of power iteration. A side longer than a limit keeps its own
// basis; vectors are stepped by Adam. Directions in which L is rounding have no eigenvectors of
// their own, though Adam's step depends on them: they get those of a fixed matrix.
struct Soap {
  Real rate = 3e-3, beta1 = 0.95, beta2 = 0.95, epsilon = 1e-8;
  Index every = 10, longest = 512;

  struct Sheet {
    Side left, right;
    Matrix M, V;                // (rows, columns), of the gradient, and of squares in the basis
    Matrix G, turned, squares;  // (rows, columns)
  };
  struct State {
    std::uint64_t steps = 0;
    std::vector<MatrixBlock> blocks;
    std::vector<Sheet> sheets;
    Real power1 = 1, power2 = 1;  // β₁ᵗ, β₂ᵗ
    SymmetricEigen eigen;
    Linearization at;
    Vector gradient;  // (n)
  };
  static void persist(State& s, Archive& archive) {
    archive(s.steps, s.power1, s.power2);
    for (Sheet& sheet : s.sheets)
      archive(sheet.left.sum, sheet.left.root, sheet.right.sum, sheet.right.root, sheet.M, sheet.V);
  }

  State init(Meter& f, const Vector&) const {
    State s;
    s.blocks = matrix_blocks(f.layout());
    for (const MatrixBlock& block : s.blocks) {
      Sheet sheet;
      sheet.left = Side(block.is_matrix() && block.rows <= longest, block.rows, 0);
      sheet.right = Side(block.is_matrix() && block.columns <= longest, block.columns, 0);
      sheet.M = sheet.V = Matrix::Zero(block.rows, block.columns);
      sheet.G = sheet.turned = sheet.squares = sheet.M;
      s.sheets.push_back(std::move(sheet));
    }
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    if (s.steps > 0) update_all(theta, s);
    const bool renews = s.steps++ % static_cast<std::uint64_t>(every) == 0;
    for (std::size_t i = 0; i < s.blocks.size(); ++i) {
      Sheet& sheet = s.sheets[i];
      sheet.G = s.blocks[i].of(s.gradient);
      observe(sheet);
      if (renews && !(renew(sheet.left, s) && renew(sheet.right, s))) {
        f.claim("a preconditioner has no eigenvectors in finite numbers");
        return Status::stalled;
      }
    }
    return Status::running;
  }

  void update_all(Vector& theta, State& s) const {
    s.power1 *= beta1;
    s.power2 *= beta2;
    for (std::size_t i = 0; i < s.blocks.size(); ++i) {
      Sheet& sheet = s.sheets[i];
      sheet.G = s.blocks[i].of(s.gradient);
      sheet.M = beta1 * sheet.M + (1 - beta1) * sheet.G;
      update(sheet, s);
      s.blocks[i].of(theta) -= rate / (1 - s.power1) * sheet.G;
    }
  }

  void observe(Sheet& sheet) const {
    sheet.turned = std::sqrt(1 - beta2) * sheet.G;
    if (sheet.left.is_used) product(Form::A_BH, sheet.turned, sheet.turned, sheet.left.sum, beta2);
    if (sheet.right.is_used)
      product(Form::AH_B, sheet.turned, sheet.turned, sheet.right.sum, beta2);
  }

  // For eigenvalues up to 1e-6 of the largest, whose eigenvectors are rounded by 1e-10 and more:
  // the eigenvectors of diag(1, 2, …) within the space that those of all others leave.
  static bool renew(Side& side, State& s) {
    constexpr Real kRounded = 1e-6;
    if (!side.is_used) return true;
    if (!symmetric_eigen(side.sum, s.eigen)) return false;
    side.root = s.eigen.V;
    const Vector& lambda = s.eigen.lambda;
    const Index n = lambda.size();
    const Index rounded = (lambda.array() <= kRounded * lambda[n - 1]).count();
    if (rounded == 0) return true;
    const Matrix known = side.root.rightCols(n - rounded);
    const Matrix P = Matrix::Identity(n, n) - known * known.transpose();
    const Vector order = Vector::LinSpaced(n, 1, static_cast<Real>(n));
    if (!symmetric_eigen(P * order.asDiagonal() * P, s.eigen)) return false;
    side.root.leftCols(rounded) = s.eigen.V.rightCols(rounded);
    return true;
  }

  // G ← Q_L (M'/(√V̂ + ε)) Q_Rᵀ
  void update(Sheet& sheet, State& s) const {
    into_basis(sheet, sheet.G);
    sheet.V = beta2 * sheet.V + (1 - beta2) * sheet.G.cwiseAbs2();
    sheet.squares = sheet.V / (1 - s.power2);
    sheet.G = sheet.M;
    into_basis(sheet, sheet.G);
    sheet.G.array() /= sheet.squares.array().sqrt() + epsilon;
    sheet.left.turn(Form::A_B, true, sheet.G, sheet.turned);
    sheet.right.turn(Form::A_BH, false, sheet.G, sheet.turned);
  }
  static void into_basis(Sheet& sheet, Matrix& G) {
    sheet.left.turn(Form::AH_B, true, G, sheet.turned);
    sheet.right.turn(Form::A_B, false, G, sheet.turned);
  }
};

void fields(Soap& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("beta1", o.beta1, decay(), "decay β₁ of the mean gradient");
  field("beta2", o.beta2, decay(), "decay β₂ of the mean squares and of the preconditioner");
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
  field("every", o.every, between(1, 1e6), "steps from one renewal of the basis to the next");
  field("longest", o.longest, between(1, 4096), "longest side that has a basis");
}

}  // namespace

void register_matrix_methods(OptimizerRegistry& registry) {
  registry.add(stepper_entry<Muon>(
      {.name = "muon",
       .title = "Muon",
       .kind = Kind::adaptive,
       .formula = "M ← μ M + ∇L,  W ← W − 0.2 η √max(rows, columns) (M Mᵀ)^(−½) M",
       .source = "Jordan (2024); Liu and others (2025), algorithm 1",
       .note = "Five Newton-Schulz steps approximate the inverse root, so that singular values are "
               "only near 1. Adam updates vectors. Without weight decay.",
       .needs = {Oracle::forward, Oracle::pullback},
       .tunable = {.option = "rate", .below = 0},
       .objection = objection_without_matrix("muon")}));
  registry.add(
      stepper_entry<Shampoo>({.name = "shampoo",
                              .title = "Shampoo",
                              .family = Family::curvature,
                              .kind = Kind::adaptive,
                              .formula = "L ← L + G Gᵀ,  R ← R + Gᵀ G,  W ← W − η L^(−¼) G R^(−¼)",
                              .source = "Gupta, Koren, Singer (2018), algorithm 1",
                              .note = "For vectors, full-matrix AdaGrad.",
                              .needs = {Oracle::forward, Oracle::pullback},
                              .tunable = {.option = "rate", .below = 4},
                              .objection = objection_of_shampoo}));
  registry.add(stepper_entry<Soap>(
      {.name = "soap",
       .title = "SOAP",
       .kind = Kind::adaptive,
       .formula =
           "W ← W − η Q_L (Q_LᵀMQ_R/(√V̂ + ε)) Q_Rᵀ,  ⟨GGᵀ⟩ = Q_L Λ Q_Lᵀ,  ⟨GᵀG⟩ = Q_R Λ Q_Rᵀ",
       .source = "Vyas and others (2024), algorithm 3",
       .note = "Adam in the eigenbasis of Shampoo's preconditioner, which is recomputed every ten "
               "steps. Adam updates vectors. The first step only fills the preconditioner.",
       .needs = {Oracle::forward, Oracle::pullback},
       .tunable = {.option = "rate", .below = 1},
       .objection = objection_without_matrix("soap")}));
}

}  // namespace isoline::optimizers
