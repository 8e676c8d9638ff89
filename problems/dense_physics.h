// Physics given one sample at a time by formulas for P, its dense Jacobian and, where small, its
// second derivatives: all that a textbook problem has to write. Products follow from the Jacobian.
#pragma once

#include "problems/problem.h"

namespace isoline::problems {

class DensePhysics : public ByJacobian {
 public:
  DensePhysics(Index inputs, Index outputs) : inputs_(inputs), outputs_(outputs) {}
  Index inputs() const final { return inputs_; }
  Index outputs() const final { return outputs_; }

  virtual void value(VectorRef x, VectorOut y) const = 0;      // (k) -> (m)
  virtual void derivative(VectorRef x, BatchOut J) const = 0;  // J (m, k), given as zeros
  virtual void second(VectorRef, VectorRef, BatchOut) const {  // x, u, H (k, k), given as zeros
    throw NotApplicable("the physics offers no second derivatives");
  }
  virtual bool invert(VectorRef /*y*/, VectorRef /*x0*/, VectorOut /*x*/) const { return false; }

  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const final;
  void curvature(BatchRef u, BatchOut out, Workspace& w) const final;
  void curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const final;
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const final;

 private:
  void form_jacobian(Matrix& J, Workspace& w) const final {
    for (Index b = 0; b < w.x.cols(); ++b)
      derivative(w.x.col(b), J.middleCols(b * inputs_, inputs_));
  }

  Index inputs_, outputs_;
};

// Common parts of the problems of Moré, Garbow and Hillstrom (1981): y* = 0, P(x) = f(x) as in the
// paper, L = ½ Σ fᵢ², half of the published Σ fᵢ². They are minimization problems: the success
// criterion is a small loss, the default of an entry.
// `minimizers` (k, count), one a column; the first counts as the truth.
ProblemParts classical(std::unique_ptr<Physics> f, const Vector& start, const Draw& draw,
                       Real minimum, const Matrix& minimizers);

Real distance_to_nearest(BatchRef x, const Matrix& minimizers);

}  // namespace isoline::problems
