// The loss L(y, y*) and its derivatives in y.
#pragma once

#include "core/array.h"

namespace isoline::problems {

class Loss {
 public:
  virtual ~Loss() = default;
  // Whether it is a multiple of ‖y − y*‖², which methods of least squares descend.
  virtual bool is_least_squares() const { return true; }
  virtual Real value(BatchRef y, BatchRef target) const = 0;
  virtual void cotangent(BatchRef y, BatchRef target, BatchOut g) const = 0;  // ∂L/∂y, (m, B)
  // ∂²L/∂y² dy, (m, B) -> (m, B)
  virtual void curvature(BatchRef y, BatchRef target, BatchRef dy, BatchOut dg) const = 0;
};

// L = weight/B Σ ½‖y − y*‖²
class HalfSquared final : public Loss {
 public:
  explicit HalfSquared(Real weight = 1) : weight_(weight) {}
  Real value(BatchRef y, BatchRef target) const override {
    return 0.5 * scale(y) * (y - target).squaredNorm();
  }
  void cotangent(BatchRef y, BatchRef target, BatchOut g) const override {
    g = scale(y) * (y - target);
  }
  void curvature(BatchRef y, BatchRef, BatchRef dy, BatchOut dg) const override {
    dg = scale(y) * dy;
  }

 private:
  Real scale(BatchRef y) const { return weight_ / static_cast<Real>(y.cols()); }
  Real weight_;
};

}  // namespace isoline::problems
