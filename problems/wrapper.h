// A physics of the unknowns of another one that it holds.
#pragma once

#include "problems/problem.h"

namespace isoline::problems {

class Wrapper : public Physics {
 public:
  virtual const Physics& inside() const = 0;
  // The unknowns of the inner physics, and their derivatives, at these.
  virtual Vector inner_point(VectorRef z) const { return z; }
  virtual Matrix inner_slopes(VectorRef z) const { return Matrix::Identity(z.size(), z.size()); }
};

// Rows of residuals below those of the data, with the target 0.
inline void add_penalties(ProblemParts& parts, Index rows) {
  parts.penalties += rows;
  parts.target.conservativeResize(parts.target.rows() + rows, Eigen::NoChange);
  parts.target.bottomRows(rows).setZero();
}
// Views of x and y as they are inside, which a problem shows no longer.
inline void leave_views_out(ProblemParts& parts) {
  parts.field.reset();
  parts.history = {};
  parts.series = {};
  parts.window.reset();
  parts.y_window.reset();
}

}  // namespace isoline::problems
