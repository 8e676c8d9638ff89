// A physics of the unknowns of another one that it holds.
#pragma once

#include "problems/physics.h"

namespace isoline::problems {

class Wrapper : public Physics {
 public:
  virtual const Physics& inside() const = 0;
  // The unknowns of the inner physics, and their derivatives, at these.
  virtual Vector inner_point(VectorRef z) const { return z; }
  virtual Matrix inner_slopes(VectorRef z) const { return Matrix::Identity(z.size(), z.size()); }
};

}  // namespace isoline::problems
