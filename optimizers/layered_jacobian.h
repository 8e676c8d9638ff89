// The Jacobian J of a network of dense layers, (m·B, n), by the factors of its layers and never
// formed: with A the inputs of a layer, a 1 below each for the bias, and G = ∂y/∂z its
// sensitivities, one row for each number of y, a row of J is for each layer the outer product of a
// row of G with the input of its sample.
#pragma once

#include <vector>

#include "optimizers/meter.h"

namespace isoline::optimizers {

class LayeredJacobian {
 public:
  void take(Linearization& at);  // m pullbacks that keep what passes
  // The lower half of K = JJᵀ = Σ_layers (G Gᵀ) ∘ (Aᵀ A ⊗ 1), (m·B, m·B).
  void gram(Matrix& K);
  // Z = Jᵀ Y and Y = J Z for columns Y (m·B, p) and Z (n, p), the parameters in an order of its
  // own: layer by layer, the bias last.
  void pullback(const Matrix& Y, Matrix& Z);
  void pushforward(const Matrix& Z, Matrix& Y);

 private:
  struct Layer {
    Matrix A, G;  // (inputs + 1, B), and transposed, (outputs, m·B)

    Index parameters() const { return A.rows() * G.rows(); }
  };

  std::vector<Layer> layers_;
  std::vector<LayerFactor> factors_;
  Index m_ = 0, samples_ = 0;
  Matrix unit_, likeness_, GG_;  // (m, B), Aᵀ A (B, B), G Gᵀ (m·B, m·B)
  Matrix cotangents_, outer_;    // of a few columns: (outputs · p, B), (outputs · p, inputs + 1)
};

}  // namespace isoline::optimizers
