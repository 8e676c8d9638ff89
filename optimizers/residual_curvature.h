// The part of the Hessian of ½‖r‖² beside JᵀJ, S ≈ Σ rᵢ∇²rᵢ, by changes of J between points where
// it was measured; Dennis, Gay, Welsch (1981), ACM TOMS 7 (NL2SOL), formulas 2.6 and 2.7. Where
// residuals remain at the solution, Gauss-Newton steps shrink by a factor; with S, ever faster.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/archive.h"
#include "core/array.h"
#include "core/decompose.h"

namespace isoline::optimizers {

class ResidualCurvature {
 public:
  // J, (m, n), measured at θ, where y* − y = b, (m).
  void measured(const Matrix& J, const Vector& theta, const Vector& b) {
    if (J_.size() > 0) update(J, theta, b);
    J_ = J;
    theta_ = theta;
    b_ = b;
  }
  // d = −(JᵀJ + S)⁻¹∇½‖r‖² over unknowns whose columns are not 0, with D as their scale; false
  // where S is unknown or the matrix not positive definite.
  bool solve(const Matrix& J, const Vector& b, const Vector& D, Vector& d) const {
    if (S_.size() == 0) return false;
    const Index n = D.size();
    Vector scale(n);
    for (Index j = 0; j < n; ++j) scale[j] = D[j] > 0 && !J.col(j).isZero(0) ? 1 / D[j] : 0;
    const Matrix A = J * scale.asDiagonal();
    Matrix H = A.transpose() * A + scale.asDiagonal() * S_ * scale.asDiagonal();
    for (Index j = 0; j < n; ++j)
      if (scale[j] == 0) H(j, j) = 1;
    Matrix right = A.transpose() * b;
    if (!cholesky(H) || !solve_by_cholesky(H, right)) return false;
    d = scale.cwiseProduct(right.col(0));
    return is_finite(d);
  }
  Real along(const Vector& d) const { return S_.size() == 0 ? 0 : d.dot(S_ * d); }  // dᵀS d
  void persist(Archive& archive) { archive(S_, J_, theta_, b_); }

 private:
  void update(const Matrix& J, const Vector& theta, const Vector& b) {
    const Vector s = theta - theta_, change = (J_ - J).transpose() * b;
    const Vector y = J_.transpose() * b_ - J.transpose() * b;
    const Real slope = s.dot(y);
    if (!(slope > 0)) return;
    if (S_.size() == 0) S_.setZero(s.size(), s.size());
    const Real bent = along(s);
    if (bent != 0) S_ *= std::min<Real>(1, std::abs(s.dot(change) / bent));
    const Vector rest = change - S_ * s;
    S_ += (rest * y.transpose() + y * rest.transpose()) / slope -
          s.dot(rest) / (slope * slope) * (y * y.transpose());
  }

  Matrix S_;          // (n, n), or empty
  Matrix J_;          // (m, n), the last that was measured
  Vector theta_, b_;  // (n), (m), there
};

}  // namespace isoline::optimizers
