// The step of a Levenberg-Marquardt method, for any damping.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/archive.h"
#include "core/array.h"
#include "core/decompose.h"
#include "core/product.h"
#include "optimizers/layered_jacobian.h"
#include "optimizers/optimizer.h"
#include "optimizers/sparse_least_squares.h"

namespace isoline::optimizers {

inline constexpr Index kLeastSquared =
    64;  // of min(m·B, n): below, QR takes no longer than Cholesky

// d = argmin ‖J d − b‖² + μ‖D d‖² for any μ. By QR of J and the damping below or beside it; or by
// Cholesky of the smaller Gram matrix of A = J D⁻¹, which is formed once for all μ, and by the
// layers of a network where they are known. What squaring A costs in digits is given back by
// corrections, each from the residual by A itself; Björck (1996), section 6.6.5. Where they do not
// converge QR is left. A sparse J is factorized as such.
class DampedLeastSquares {
 public:
  void start(const Meter& f) {
    is_sparse_ = f.is_sparse();
    if (is_sparse_) sparse_.start(*f.sparse_pattern());
  }
  // Scaling and factorization as the method's options have them.
  void set(Meter& f, Linearization& at, const Vector& theta, const Vector& b,
           std::string_view scaling) {
    const Index n = f.unknowns();
    rows_ = b.size();
    has_gram_ = false;
    factored_ = -1;
    // An audit grants both, and J serves any problem.
    is_layered_ =
        f.is_granted(Oracle::layer_factors) && !f.is_granted(Oracle::jacobian) && !is_sparse_;
    if (is_sparse_) {
      norms_.resize(n);
      f.sparse_pattern()->squared_columns(at.sparse_jacobian().data(), norms_);
      norms_ = norms_.cwiseSqrt();
    } else if (is_layered_) {
      layered_.take(at);
      layered_.order(f.layout(), order_);
      layered_.squared_columns(pulled_);
      norms_.resize(n);
      norms_(order_) = pulled_.cwiseSqrt();
    } else {
      J_ = at.jacobian();
      if (const Bounds* bounds = f.bounds()) {
        pulled_.noalias() = -(J_.transpose() * b);  // a multiple of ∇L
        for (Index i = 0; i < n; ++i)
          if (bounds->is_active(theta, pulled_, i)) J_.col(i).setZero();
      }
      norms_ = J_.colwise().norm();
    }
    if (scale_.size() != n) scale_.setZero(n);
    if (scaling == "more") scale_ = scale_.cwiseMax(norms_);
    if (scaling == "fading") scale_ = (scale_ / 2).cwiseMax(norms_);
    if (scaling == "none") scale_.setOnes();
    if (scaling == "jacobian") scale_ = norms_;
    // A parameter that has done nothing yet has no scale, and no step.
    inverse_ = (scale_.array() > 0).select(scale_.cwiseInverse(), 1);
    if (is_layered_) inverse_ = inverse_(order_).eval();
    if (is_sparse_) sparse_.set(at.sparse_jacobian(), inverse_);
    const Index size = is_wide() ? rows_ : rows_ + n;
    if (right_.size() != size) right_.setZero(size);
    set_right(b);
  }
  void set_right(const Vector& b) { right_.head(rows_) = b; }
  void hold(Index i) { J_.col(i).setZero(); }  // no step of it, after set() of a dense J
  // d and J d; false where they are not finite.
  bool solve(Real mu, std::string_view factorization, Vector& d, Vector& Jd) {
    if (is_sparse_) {
      if (!sparse_.solve(mu, right_.head(rows_), step_, Jd)) return false;
      d = (scale_.array() > 0).select(step_.cwiseProduct(inverse_), 0);
      return true;
    }
    const bool is_large = std::min(rows_, scale_.size()) >= kLeastSquared;
    const bool squares = factorization == "cholesky" || (factorization == "auto" && is_large);
    if (squares && by_cholesky(mu)) {
      d.resize(scale_.size());
      if (is_layered_)
        d(order_) = step_.cwiseProduct(inverse_);
      else
        d = step_.cwiseProduct(inverse_);
      d = (scale_.array() > 0).select(d, 0);
      Jd = moved_;
      return true;
    }
    if (is_layered_) form_jacobian();
    if (!by_qr(mu, d)) return false;
    Jd = moved_;
    return true;
  }
  const Matrix& jacobian() const {
    return J_;
  }  // (m·B, n), those of unknowns that a bound holds are 0
  void push_dense(const Vector& d, Vector& Jd) const { Jd.noalias() = J_ * d; }
  Real misfit() const { return 0.5 * right_.squaredNorm(); }  // ½‖b‖²
  const Vector& scale() const { return scale_; }              // (n) D
  Real squared_length(const Vector& d) const { return scale_.cwiseProduct(d).squaredNorm(); }
  void persist(Archive& archive) {
    archive(rows_, is_layered_, J_, right_, scale_, inverse_, order_);
    layered_.persist(archive);
    sparse_.persist(archive);
  }

 private:
  bool is_wide() const { return rows_ < scale_.size(); }
  // moved_ = A s
  void push(const Vector& s) {
    wide_ = s.cwiseProduct(inverse_);
    if (is_layered_) {
      layered_.pushforward(wide_, tall_);
      moved_ = tall_.col(0);
    } else {
      moved_.noalias() = J_ * wide_.col(0);
    }
  }
  // pulled_ = Aᵀ y
  void pull(const Vector& y) {
    if (is_layered_) {
      tall_ = y;
      layered_.pullback(tall_, wide_);
      pulled_ = wide_.col(0).cwiseProduct(inverse_);
    } else {
      pulled_.noalias() = J_.transpose() * y;
      pulled_.array() *= inverse_.array();
    }
  }
  void form_gram() {
    if (has_gram_) return;
    has_gram_ = true;
    if (is_layered_) {
      pulled_ = inverse_.cwiseAbs2();
      layered_.weighted_gram(pulled_, gram_);
      return;
    }
    scaled_ = J_ * inverse_.asDiagonal();
    const Index r = std::min(J_.rows(), J_.cols());
    gram_.resize(r, r);
    product(is_wide() ? Form::A_BH : Form::AH_B, scaled_, scaled_, gram_);
  }
  // (AAᵀ + μ) z = b and s = Aᵀz where A is wide, else (AᵀA + μ) s = Aᵀb.
  bool by_cholesky(Real mu) {
    constexpr int kMostCorrections = 6;
    constexpr Real kEnough = 1e-10;  // of the correction that is left out
    form_gram();
    if (factored_ != mu) {
      factored_ = -1;
      factor_ = gram_;
      factor_.diagonal().array() += mu;
      if (!cholesky(factor_)) return false;
      factored_ = mu;
    }
    rest_ = right_.head(rows_);
    if (!is_wide()) pull(rest_);
    solution_ = is_wide() ? rest_ : pulled_;
    if (!solve_by_cholesky(factor_, solution_)) return false;
    for (int i = 0; i < kMostCorrections; ++i) {
      correct(mu);
      if (!solve_by_cholesky(factor_, correction_)) return false;
      if (correction_.norm() <= kEnough * solution_.norm()) return true;
      solution_ += correction_;
    }
    return false;
  }
  // correction_ = the residual of solution_
  void correct(Real mu) {
    rest_ = solution_.col(0);
    if (is_wide()) {
      pull(rest_);
      step_ = pulled_;
      push(step_);
      correction_ = right_ - moved_ - mu * rest_;
    } else {
      step_ = rest_;
      push(step_);
      rest_ = right_.head(rows_) - moved_;
      pull(rest_);
      correction_ = pulled_ - mu * step_;
    }
  }
  bool by_qr(Real mu, Vector& d) {
    const Index n = J_.cols();
    const Real root = std::sqrt(mu);
    if (!is_wide()) {
      scaled_.setZero(rows_ + n, n);
      scaled_.topRows(rows_) = J_;
      scaled_.bottomRows(n).diagonal() = root * scale_;
      // Columns may differ by any factor in scale. The damping alone bounds the step along them.
      constexpr Real kNoneIsDependent = std::numeric_limits<Real>::min();
      if (!least_squares(scaled_, right_, kNoneIsDependent, d)) return false;
      moved_.noalias() = scaled_.topRows(rows_) * d;
      return true;
    }
    scaled_.setZero(rows_, n + rows_);
    for (Index j = 0; j < n; ++j) scaled_.col(j) = J_.col(j) / (scale_[j] > 0 ? scale_[j] : 1);
    scaled_.rightCols(rows_).diagonal().setConstant(root);
    if (!least_squares(scaled_, right_, std::numeric_limits<Real>::epsilon(), step_)) return false;
    d = (scale_.array() > 0).select(step_.head(n).cwiseQuotient(scale_), 0);
    moved_.noalias() = scaled_.leftCols(n) * step_.head(n);
    return true;
  }
  void form_jacobian() {  // from the layers
    layered_.pullback(Matrix::Identity(rows_, rows_), wide_);
    J_.resize(rows_, wide_.rows());
    for (Index i = 0; i < wide_.rows(); ++i) J_.col(order_[i]) = wide_.row(i).transpose();
    inverse_ = (scale_.array() > 0).select(scale_.cwiseInverse(), 1);
    is_layered_ = has_gram_ = false;
    factored_ = -1;
  }

  Index rows_ = 0;  // m·B
  bool is_layered_ = false, has_gram_ = false;
  Real factored_ = -1;  // the μ of factor_; negative: none
  LayeredJacobian layered_;
  bool is_sparse_ = false;
  SparseLeastSquares sparse_;
  Eigen::Matrix<Index, Eigen::Dynamic, 1> order_;  // (n) in θ of the layers' parameters
  Matrix J_;                                       // (m·B, n), unless it is layered
  Vector right_;                                   // b, with n zeros below where J is not wide
  Vector scale_, inverse_;  // (n) D, and D⁻¹ in the order of the layers where they are used

  // Scratch: r = min(m·B, n).
  Matrix gram_, factor_;                         // (r, r)
  Matrix solution_, correction_;                 // (r, 1)
  Matrix scaled_, wide_, tall_;                  // A or what QR takes, (n, 1), (m·B, 1)
  Vector norms_, step_, moved_, pulled_, rest_;  // (n) ‖J_j‖, s = D d; (m·B) A s; (n); (m·B)
};

}  // namespace isoline::optimizers
