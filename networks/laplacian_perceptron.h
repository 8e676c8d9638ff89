// A perceptron of hyperbolic tangents in double precision that carries derivatives in its input p
// along with its value u, for physics-informed networks: each point that asks for them has d + 2
// lanes through the layers, value, gradient and Laplacian, with z = W a + b, and for the others z =
// W a without b,
//   a = s(z),  ∂ᵢa = s' ∂ᵢz,  Δa = s' Δz + s'' Σ (∂ᵢz)²,
// and every product with J is one matrix product per layer over all lanes of all points.
#pragma once

#include <string>

#include "networks/network.h"

namespace isoline::networks {

struct LaplacianShape {
  std::vector<Index> widths;  // d, the hidden layers', 1
  Index curved = 0;           // Δ is the sum of ∂ᵢ² over so many coordinates, the first ones
  bool shows_gradient = false;
  Real deviation = 0;     // weights and biases of the start are N(0, deviation²), or where it
                          // is 0 PyTorch's U(±1/√inputs)
  Vector constants = {};  // start of further unknowns, the last of θ, shown beside each point
};

// The widths from d and "64-48"; `of` names the problem in a UsageError.
std::vector<Index> perceptron_widths(const std::string& of, Index dimension,
                                     const std::string& layers);

// θ, (p; 1, or 0 where derivatives are not needed and shown as 0) ↦ (u; ∇u if shown; Δu;
// constants), (d + 1, B) -> (k, B).
std::unique_ptr<Network> laplacian_perceptron(LaplacianShape shape);

}  // namespace isoline::networks
