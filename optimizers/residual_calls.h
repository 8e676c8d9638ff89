// The common part of adapters to least-squares libraries: r = (y − y*)/√B and its Jacobian at the
// points of a library, its iterates and rejected steps, and the end of its run. A library is given
// finite numbers alone: large residuals where an evaluation fails, which it rejects.
#pragma once

#include <cmath>
#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include "optimizers/optimizer.h"

namespace isoline::optimizers {

// In each component of r. Its square fits, and sums of squares.
inline constexpr Real kFailedResidual = 1e100;
inline constexpr const char* kFailedNote =
    "Where an evaluation fails, the library is given residuals of 1e100.";

class ResidualCalls {
 public:
  ResidualCalls(Meter& f, const Vector& start) : f_(f), last_(start) {}

  // At a trial point, which a library rejects unless it asks for the Jacobian next. False if the
  // library must stop. No exception leaves this function or the next one: libraries are in C.
  bool residual(const double* theta, double* r) noexcept {
    if (has_trial_) f_.reject_step();
    has_trial_ = true;
    repeats_ = is_known(theta) ? repeats_ + 1 : 0;
    has_point_ = false;
    return at(theta, [&] { give(r); });
  }
  // At a point of a difference quotient around the last iterate. Each call counts, also at the
  // point of the last one. Where it fails, r is extrapolated from the other side; if that fails,
  // too, the quotient is 0.
  bool evaluate(const double* theta, double* r) noexcept {
    if (has_point_ && theta_ == last_) base_ = residual_;
    has_point_ = false;
    if (!at(theta, [&] { give(r); })) return false;
    if (!has_failed_ || base_.size() != residual_.size()) return true;
    const Vector mirrored = 2 * last_ - theta_;
    return at(mirrored.data(), [&] {
      Eigen::Map<Vector>(r, base_.size()) = has_failed_ ? base_ : Vector(2 * base_ - residual_);
    });
  }
  // Passes r (m·B) and ∂r/∂θ (m·B, n) to `read`; a point of the last residual is not evaluated
  // again.
  template <class Read>
  bool jacobian(const double* theta, Read read) noexcept {
    return accept() && at(theta, [&] {
             scaled_ = f_.residual_unit() * point_.jacobian() /
                       std::sqrt(static_cast<Real>(f_.samples()));
             lacks_columns_ = false;
             for (Index j = 0; j < scaled_.cols(); ++j) {  // of differences, of which a call failed
               if (scaled_.col(j).allFinite()) continue;
               scaled_.col(j).setZero();
               lacks_columns_ = true;
             }
             read(residual_, scaled_);
           });
  }
  // The same of a sparse J: its values by Meter::sparse_pattern().
  template <class Read>
  bool sparse_jacobian(const double* theta, Read read) noexcept {
    return accept() && at(theta, [&] { read(point_.sparse_jacobian()); });
  }
  // The library has accepted its last trial, where it has made one since the last Jacobian.
  bool accept() noexcept {
    if (has_trial_ && has_point_ && theta_ != last_) return report(theta_);
    has_trial_ = false;
    return !is_over();
  }
  bool report(const Vector& theta) noexcept {
    has_trial_ = false;
    try {
      last_ = theta;
      return f_.iterate(last_) == Status::running;
    } catch (...) {
      error_ = std::current_exception();
      return false;
    }
  }
  bool is_over() const {
    return error_ || repeats_ >= InARow::kMostRepeats || f_.is_spent() ||
           f_.status() != Status::running;
  }

  // After the library's loop: its point, and what it states about its own success.
  Status end(Vector& theta, std::string_view words, Status by_its_test) {
    const bool was_stopped = is_over();  // by us, which the library does not know
    if (!was_stopped && is_finite(theta) && theta != last_ && !(has_failed_ && theta == theta_))
      report(theta);
    if (std::exchange(has_trial_, false)) f_.reject_step();
    if (error_) std::rethrow_exception(error_);
    theta = last_;
    f_.claim(was_stopped ? "stopped" : words);
    if (f_.status() != Status::running) return f_.status();
    if (repeats_ >= InARow::kMostRepeats) {
      f_.remark(InARow::kOfOneX);
      return Status::stalled;
    }
    if (f_.is_spent()) return Status::budget;
    return lacks_columns_ && by_its_test == Status::converged ? Status::stalled : by_its_test;
  }

 private:
  bool is_known(const double* theta) const {
    return has_point_ && theta_ == Eigen::Map<const Vector>(theta, last_.size());
  }
  void give(double* r) const {
    Eigen::Map<Vector> given(r, residual_.size());
    has_failed_ ? given.setConstant(kFailedResidual) : given = residual_;
  }
  template <class Read>
  bool at(const double* theta, Read read) noexcept {
    if (is_over()) return false;
    try {
      if (!is_known(theta)) {
        has_point_ = false;
        theta_ = Eigen::Map<const Vector>(theta, last_.size());
        f_.linearize(theta_, point_);
        point_.residual(residual_);
        residual_ *= f_.residual_unit();
        has_failed_ = !is_finite(residual_);
        has_point_ = true;
      }
      read();
      return true;
    } catch (const BudgetSpent&) {  // the meter records it
    } catch (...) {
      error_ = std::current_exception();
    }
    return false;
  }

  Meter& f_;
  Vector last_;              // (n), the last iterate
  Vector theta_, residual_;  // (n), (m·B) at `point_`
  Linearization point_;
  Matrix scaled_;  // (m·B, n)
  Vector base_;    // (m·B), r at last_, for difference quotients
  bool has_point_ = false, has_trial_ = false;
  bool has_failed_ = false;     // the evaluation of `point_`
  bool lacks_columns_ = false;  // of the last Jacobian
  int repeats_ = 0;
  std::exception_ptr error_;
};

// The objection of methods that need as many residuals as unknowns.
inline std::string too_few_residuals(const OptionValues&, const Problem& problem) {
  return problem.residuals() < problem.unknowns() ? "it needs as many residuals as unknowns" : "";
}

}  // namespace isoline::optimizers
