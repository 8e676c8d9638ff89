// A differentiable process P : x (k, B) -> y (m, B), given a context c (p, B), empty for most. One
// sample a column. Const: what a forward pass leaves behind lives in the caller's Workspace, and
// the products are taken at the x of the last forward, which the caller has put into w.x.
#pragma once

#include "core/array.h"
#include "core/errors.h"
#include "core/workspace.h"

namespace isoline::problems {

// How far a local inverse can be trusted.
enum class Inverse {
  none,
  exact,        // P(P⁻¹(y; x₀)) = y
  damped,       // exact where the data carry evidence, held back elsewhere
  estimate,     // an informed guess, by how the data were made
  approximate,  // found from P itself, within an error: reversed steps, a few steps of a search
};

// What a physics has of products with J, and what each costs in forwards.
struct Products {
  bool has_pushforward = true, has_pullback = true;
  Index pushforward_price = 1, pullback_price = 1;
  bool are_differences = false;  // quotients of forwards, of some eight digits
};

class Physics {
 public:
  virtual ~Physics() = default;

  virtual Index inputs() const = 0;   // k
  virtual Index outputs() const = 0;  // m

  virtual void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const = 0;
  virtual void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const = 0;  // (k, B) -> (m, B)
  virtual void pullback(BatchRef u, BatchOut JTu, Workspace& w) const = 0;    // (m, B) -> (k, B)

  // Who lacks one leaves it out here, and is not asked for it.
  virtual Products products() const { return {}; }
  // Another process computes it, whose time is not this one's.
  virtual bool is_elsewhere() const { return false; }

  // J of each sample, side by side: (m, k·B). By default from the cheaper product.
  virtual void jacobian(BatchOut J, Workspace& w) const;

  // Σᵢ uᵢ ∇²Pᵢ of each sample, side by side: (k, k·B), u (m, B).
  virtual bool has_curvature() const { return false; }
  virtual void curvature(BatchRef u, BatchOut out, Workspace& w) const;
  // (Σᵢ uᵢ ∇²Pᵢ) v of each sample, (k, B). By default through the matrices.
  virtual void curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const;

  // The x nearest x0 with P(x) = y, for every sample that has one.
  virtual Inverse inverse_kind() const { return Inverse::none; }
  virtual Index inverse_price() const { return 1; }  // in forwards
  virtual Success local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const;
};

}  // namespace isoline::problems
