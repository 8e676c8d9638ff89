// SOAP, Vyas and others (2024), arXiv 2409.11321, algorithm 3: Adam in the eigenbasis of Shampoo's
// preconditioner. Of each matrix of weights with gradient G, L ← β₂ L + (1 − β₂) G Gᵀ and
// R ← β₂ R + (1 − β₂) Gᵀ G have the eigenvectors Q_L and Q_R; G' = Q_Lᵀ G Q_R, M' = Q_Lᵀ M Q_R,
// V ← β₂ V + (1 − β₂) G'², W ← W − η Q_L (M̂'/(√V̂ + ε)) Q_Rᵀ. As in the authors' code the first step
// only fills L and R, and the basis is renewed after an update, every few steps; here by all
// eigenvectors instead of one step of power iteration. A side longer than a limit keeps its own
// basis; vectors are stepped by Adam. Directions in which L is rounding have no eigenvectors of
// their own, though Adam's step depends on them: they get those of a fixed matrix.
#include <cmath>

#include "core/decompose.h"
#include "core/product.h"
#include "optimizers/matrix_blocks.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Soap {
  Real rate = 3e-3, beta1 = 0.95, beta2 = 0.95, epsilon = 1e-8;
  Index every = 10, longest = 512;

  struct Side {
    bool is_used = false;
    Matrix mean, basis;  // (side, side): L or R, Q
  };
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
      archive(sheet.left.mean, sheet.left.basis, sheet.right.mean, sheet.right.basis, sheet.M,
              sheet.V);
  }

  State init(Meter& f, const Vector&) const {
    State s;
    s.blocks = matrix_blocks(f.layout());
    for (const MatrixBlock& block : s.blocks) {
      Sheet sheet;
      prepare(sheet.left, block, block.rows);
      prepare(sheet.right, block, block.columns);
      sheet.M = sheet.V = Matrix::Zero(block.rows, block.columns);
      sheet.G = sheet.turned = sheet.squares = sheet.M;
      s.sheets.push_back(std::move(sheet));
    }
    return s;
  }
  void prepare(Side& side, const MatrixBlock& block, Index size) const {
    side.is_used = block.is_matrix() && size <= longest;
    if (side.is_used) side.mean = Matrix::Zero(size, size);
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
    if (sheet.left.is_used) product(Form::A_BH, sheet.turned, sheet.turned, sheet.left.mean, beta2);
    if (sheet.right.is_used)
      product(Form::AH_B, sheet.turned, sheet.turned, sheet.right.mean, beta2);
  }

  // For eigenvalues up to 1e-6 of the largest, whose eigenvectors are rounded by 1e-10 and more:
  // the eigenvectors of diag(1, 2, …) within the space that those of all others leave.
  static bool renew(Side& side, State& s) {
    constexpr Real kRounded = 1e-6;
    if (!side.is_used) return true;
    if (!symmetric_eigen(side.mean, s.eigen)) return false;
    side.basis = s.eigen.V;
    const Vector& lambda = s.eigen.lambda;
    const Index n = lambda.size();
    const Index rounded = (lambda.array() <= kRounded * lambda[n - 1]).count();
    if (rounded == 0) return true;
    const Matrix known = side.basis.rightCols(n - rounded);
    const Matrix P = Matrix::Identity(n, n) - known * known.transpose();
    const Vector order = Vector::LinSpaced(n, 1, static_cast<Real>(n));
    if (!symmetric_eigen(P * order.asDiagonal() * P, s.eigen)) return false;
    side.basis.leftCols(rounded) = s.eigen.V.rightCols(rounded);
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
    turn(sheet.left, Form::A_B, true, sheet.G, sheet.turned);
    turn(sheet.right, Form::A_BH, false, sheet.G, sheet.turned);
  }
  static void into_basis(Sheet& sheet, Matrix& G) {
    turn(sheet.left, Form::AH_B, true, G, sheet.turned);
    turn(sheet.right, Form::A_B, false, G, sheet.turned);
  }
  static void turn(const Side& side, Form form, bool is_left, Matrix& G, Matrix& room) {
    if (!side.is_used) return;
    room.resize(G.rows(), G.cols());
    is_left ? product(form, side.basis, G, room) : product(form, G, side.basis, room);
    std::swap(G, room);
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

std::string objection(const OptionValues&, const Problem& problem) {
  return has_matrix(problem) ? "" : "soap needs a matrix of weights, and the problem has none";
}

}  // namespace

void register_soap(OptimizerRegistry& registry) {
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
       .objection = objection}));
}

}  // namespace isoline::optimizers
