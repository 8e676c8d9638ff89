// Golub-Kahan bidiagonalization with one side orthogonalized, and functions of what it finds.
#include "optimizers/lanczos_step.h"

#include <algorithm>
#include <cmath>

namespace isoline::optimizers {
namespace {

constexpr Real kMostBytes = 512.0 * 1024 * 1024;

// B, (size, size).
Matrix bidiagonal(const std::vector<Real>& alpha, const std::vector<Real>& beta, Index size) {
  Matrix B = Matrix::Zero(size, size);
  for (Index i = 0; i < size; ++i) {
    B(i, i) = alpha[static_cast<std::size_t>(i)];
    if (i + 1 < size) B(i, i + 1) = beta[static_cast<std::size_t>(i)];
  }
  return B;
}

}  // namespace

void LanczosStep::forward(Linearization& at, VectorRef s, Vector& out) {
  cotangent_.resize(at.y().rows(), at.y().cols());
  if (is_over_parameters_) {
    at.pushforward(s, cotangent_);
    out = cotangent_.reshaped();
  } else {
    cotangent_ = s.reshaped(at.y().rows(), at.y().cols());
    out.resize(unknowns_);
    at.pullback(cotangent_, out);
  }
}

void LanczosStep::backward(Linearization& at, const Vector& t, Vector& out) {
  cotangent_.resize(at.y().rows(), at.y().cols());
  if (is_over_parameters_) {
    cotangent_ = t.reshaped(at.y().rows(), at.y().cols());
    out.resize(unknowns_);
    at.pullback(cotangent_, out);
  } else {
    at.pushforward(t, cotangent_);
    out = cotangent_.reshaped();
  }
}

// s₁ is Jᵀw over the parameters, else w.
void LanczosStep::start(Linearization& at, const Vector& w, Index most) {
  alpha_.clear();
  beta_.clear();
  vectors_ = 0;
  is_exhausted_ = false;
  s_ = w;
  if (is_over_parameters_) {
    cotangent_ = w.reshaped(at.y().rows(), at.y().cols());
    s_.resize(unknowns_);
    at.pullback(cotangent_, s_);
  }
  length_ = s_.norm();
  S_.resize(s_.size(), most);
  if (length_ > 0) S_.col(0) = s_ / length_;
}

bool LanczosStep::extend(Linearization& at) {
  constexpr Real kExhausted = 1e-14;  // of the largest so far: rounding
  const Index k = vectors_;
  forward(at, S_.col(k), t_);
  if (k > 0) t_ -= beta_.back() * last_t_;
  const Real alpha = t_.norm();
  const Real largest = alpha_.empty() ? alpha : *std::max_element(alpha_.begin(), alpha_.end());
  is_exhausted_ = !(alpha > kExhausted * largest);
  if (is_exhausted_) return false;
  t_ /= alpha;
  backward(at, t_, s_);
  s_ -= alpha * S_.col(k);
  for (int pass = 0; pass < 2; ++pass) {  // "twice is enough", Parlett (1998), §6.9
    overlap_.noalias() = S_.leftCols(k + 1).transpose() * s_;
    s_.noalias() -= S_.leftCols(k + 1) * overlap_;
  }
  const Real beta = s_.norm();
  alpha_.push_back(alpha);
  beta_.push_back(beta);
  vectors_ = k + 1;
  std::swap(t_, last_t_);
  is_exhausted_ = !(beta > kExhausted * largest);
  if (is_exhausted_ || vectors_ == S_.cols()) return false;
  S_.col(vectors_) = s_ / beta;
  return true;
}

// ‖s‖ h(BᵀB) e₁ of the first `size` vectors.
void LanczosStep::solve(const SpectralFilter& filter, Index size, Vector& out) {
  out.setZero(vectors_);
  if (size == 0 || !thin_svd(bidiagonal(alpha_, beta_, size), svd_)) return;
  const Spectrum spectrum{.largest = svd_.sigma[0]};
  overlap_ = length_ * svd_.Vt.col(0);
  for (Index i = 0; i < size; ++i) overlap_[i] *= filter.over_sigma(svd_.sigma[i], spectrum);
  out.head(size).noalias() = svd_.Vt.transpose() * overlap_;
}

// The length of a step with these coefficients: ‖S c‖, or ‖Jᵀ S c‖ = ‖T B c‖.
Real LanczosStep::distance(const Vector& coefficients) const {
  if (is_over_parameters_) return coefficients.norm();
  return (bidiagonal(alpha_, beta_, vectors_) * coefficients).norm();
}

bool LanczosStep::add(Meter& f, Linearization& at, const SpectralFilter& filter,
                      const KrylovLimits& limits, const Vector& w, Real factor, Vector& out) {
  constexpr Index kFirstLook = 6;
  unknowns_ = out.size();
  is_over_parameters_ = unknowns_ <= w.size();
  const Index r = std::min(w.size(), out.size());
  const auto room = static_cast<Index>(kMostBytes / (sizeof(Real) * static_cast<Real>(r)));
  start(at, w, std::clamp<Index>(std::min(limits.vectors, r), 1, std::max<Index>(room, 1)));
  if (!std::isfinite(length_)) return false;
  if (length_ == 0) return true;
  Index next_look = kFirstLook;
  bool is_open = true;
  error_ = 1;
  while (is_open && error_ > limits.tolerance) {
    is_open = extend(at) && !f.is_spent();
    if (is_open && vectors_ < next_look) continue;
    next_look = vectors_ + std::max<Index>(1, vectors_ / 8);
    solve(filter, vectors_, solution_);
    solve(filter, 2 * vectors_ / 3, earlier_);
    const Real length = distance(solution_);
    // A space that no product leaves holds the step itself.
    error_ = length > 0 && !is_exhausted_ ? distance(solution_ - earlier_) / length : 0;
  }
  if (vectors_ == 0 || !is_finite(solution_)) return vectors_ == 0;
  s_.noalias() = S_.leftCols(vectors_) * solution_;
  if (!is_over_parameters_) {
    cotangent_ = s_.reshaped(at.y().rows(), at.y().cols());
    t_.resize(unknowns_);
    at.pullback(cotangent_, t_);
    out += factor * t_;
  } else {
    out += factor * s_;
  }
  return true;
}

}  // namespace isoline::optimizers
