// K = JJᵀ of a network of dense layers, layer by layer and without J: with A the inputs of a layer
// and G = ∂y/∂z its sensitivities, one row for each number of y,
//   K = Σ_layers (G Gᵀ) ∘ ((Aᵀ A + 1) ⊗ 1),
// since a row of J is the outer product of a row of G with an input; the 1 within is the bias.
#pragma once

#include <vector>

#include "optimizers/meter.h"

namespace isoline::optimizers {

class LayeredGram {
 public:
  // The lower half of K, (m·B, m·B); m pullbacks that keep what passes.
  void form(Linearization& at, Matrix& K);

 private:
  void add_layer(const LayerFactor& factor, const Matrix& G, Matrix& K);

  std::vector<LayerFactor> factors_;
  std::vector<Matrix> G_;        // of each layer, transposed: (its width, m·B)
  Matrix unit_, likeness_, GG_;  // (m, B), Aᵀ A + 1 (B, B), G Gᵀ (m·B, m·B)
};

}  // namespace isoline::optimizers
