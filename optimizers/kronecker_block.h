// The curvature of one layer, dense or convolution, as A ⊗ G, and the step through its damped
// inverse: with π² = (tr A/dim A)/(tr G/dim G),
//   [W b] ← [W b] − η (G + √λ/π I)⁻¹ ∇L (A + π√λ I)⁻¹.
#pragma once

#include <cmath>

#include "core/decompose.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

class KroneckerBlock {
 public:
  Matrix A, G;  // (columns + 1)² and (rows)² of [W b], lower halves

  // Shrinks the running means by `kept`, to which are then added: of a dense layer, its inputs a,
  // (columns, B), as ā āᵀ, or outer products made elsewhere.
  void fade(Real kept, Index inputs, Index outputs) {
    if (A.size() == 0) {
      A.setZero(inputs, inputs);
      G.setZero(outputs, outputs);
    }
    A *= kept;
    G *= kept;
  }
  void add_inputs(const Matrix& a, Real share) {
    a_.setOnes(a.rows() + 1, a.cols());
    a_.topRows(a.rows()) = a;
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

}  // namespace isoline::optimizers
