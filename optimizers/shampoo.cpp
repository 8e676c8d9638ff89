// Shampoo, Gupta, Koren, Singer (2018), algorithm 1: of each matrix of weights with gradient G,
// L ← L + G Gᵀ, R ← R + Gᵀ G, W ← W − η L^(−¼) G R^(−¼), from L = R = ε I; of a vector L^(−½) g,
// which is AdaGrad with its full matrix. A side longer than a limit is left alone, and the other's
// exponent is then −½. The roots can be renewed every few steps only; but a root of a few gradients
// is vast where they have not been, and one that is kept too long makes the next step diverge.
#include <fmt/format.h>

#include <cmath>

#include "core/decompose.h"
#include "core/product.h"
#include "optimizers/matrix_blocks.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Shampoo {
  Real rate = 0.1, epsilon = 1e-4;
  Index every = 1, longest = 512;

  struct Side {
    bool is_used = false;
    Matrix sum, root;  // (side, side): L or R, and its negative power
  };
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
      Sheet sheet;
      prepare(sheet.left, block.rows);
      if (block.columns > 1) prepare(sheet.right, block.columns);
      s.sheets.push_back(std::move(sheet));
    }
    return s;
  }
  void prepare(Side& side, Index size) const {
    side.is_used = size <= longest;
    if (side.is_used) side.sum = epsilon * Matrix::Identity(size, size);
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
    sheet.step.resize(sheet.G.rows(), sheet.G.cols());
    if (sheet.left.is_used) {
      product(Form::A_B, sheet.left.root, sheet.G, sheet.step);
      std::swap(sheet.G, sheet.step);
    }
    if (sheet.right.is_used) {
      product(Form::A_B, sheet.G, sheet.right.root, sheet.step);
      std::swap(sheet.G, sheet.step);
    }
  }
};

void fields(Shampoo& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("epsilon", o.epsilon, above(0), "ε of the sums at the start");
  field("every", o.every, between(1, 1e6), "steps from one renewal of the roots to the next");
  field("longest", o.longest, between(1, 4096), "longest side that has a preconditioner");
}

std::string objection(const OptionValues& options, const Problem& problem) {
  const auto longest = static_cast<Index>(options.number("longest", 0));
  for (const MatrixBlock& block : matrix_blocks(problem.layout()))
    if (std::min(block.rows, block.columns > 1 ? block.columns : block.rows) <= longest) return "";
  return fmt::format("no side of its unknowns has a length up to {}", longest);
}

}  // namespace

void register_shampoo(OptimizerRegistry& registry) {
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
                              .objection = objection}));
}

}  // namespace isoline::optimizers
