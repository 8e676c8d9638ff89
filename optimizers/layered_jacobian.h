// The Jacobian J of a network of dense layers, (m·B, n), by the factors of its layers and never
// formed: with A the inputs of a layer, a 1 below each for the bias, and G = ∂y/∂z its
// sensitivities, one row for each number of y, a row of J is for each layer the outer product of a
// row of G with the input of its sample.
#pragma once

#include <vector>

#include "core/archive.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

class LayeredJacobian {
 public:
  void take(Linearization& at);                 // m pullbacks that keep what passes
  Index rows() const { return m_ * samples_; }  // m·B
  // The lower half of K = JJᵀ = Σ_layers (G Gᵀ) ∘ (Aᵀ A ⊗ 1), (m·B, m·B).
  void gram(Matrix& K);
  // The same of J diag(w) Jᵀ, w (n) in the order of its own.
  void weighted_gram(const Vector& w, Matrix& K);
  // The squared norms of J's columns, (n) in the order of its own.
  void squared_columns(Vector& out);
  // Z = Jᵀ Y and Y = J Z for columns Y (m·B, p) and Z (n, p), the parameters in an order of its
  // own: layer by layer, the bias last.
  void pullback(const Matrix& Y, Matrix& Z);
  void pushforward(const Matrix& Z, Matrix& Y);
  // Where in θ each parameter of that order stands.
  void order(const std::vector<Block>& layout, Eigen::Matrix<Index, Eigen::Dynamic, 1>& out) const;
  void persist(Archive& archive);

 private:
  struct Layer {
    Matrix A, G;         // (inputs + 1, B), and transposed, (outputs, m·B)
    Index weight, bias;  // in the layout

    Index parameters() const { return A.rows() * G.rows(); }
  };

  std::vector<Layer> layers_;
  std::vector<LayerFactor> factors_;
  Index m_ = 0, samples_ = 0;
  Matrix unit_, likeness_, GG_;      // (m, B), Aᵀ A (B, B), G Gᵀ (m·B, m·B)
  Matrix shares_, pairs_, weighed_;  // of one sample with others: Σ w a a, a a, G by those
  Matrix cotangents_, outer_;  // of a few columns: (outputs · p, B), (outputs · p, inputs + 1)
};

}  // namespace isoline::optimizers
