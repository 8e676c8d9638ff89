// The common part of adapters to least-squares libraries: r = (y − y*)/√B and its Jacobian at the
// points of a library, its iterates and rejected steps, and the end of its run.
#pragma once

#include <cmath>
#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include "optimizers/optimizer.h"

namespace isoline::optimizers {

class ResidualCalls {
 public:
  ResidualCalls(Meter& f, const Vector& start) : f_(f), last_(start) {}

  // At a trial point, which a library rejects unless it asks for the Jacobian next. False if the
  // library must stop. No exception leaves this function or the next one: libraries are in C.
  bool residual(const double* theta, double* r) noexcept {
    if (has_trial_) f_.reject_step();
    has_trial_ = true;
    return evaluate(theta, r);
  }
  // At a point of a difference quotient. Each call counts, also at the point of the last one.
  bool evaluate(const double* theta, double* r) noexcept {
    has_point_ = false;
    return at(theta, [&] { Eigen::Map<Vector>(r, residual_.size()) = residual_; });
  }
  // Passes r (m·B) and ∂r/∂θ (m·B, n) to `read`; a point of the last residual is not evaluated
  // again.
  template <class Read>
  bool jacobian(const double* theta, Read read) noexcept {
    return accept() && at(theta, [&] {
             scaled_ = point_.jacobian() / std::sqrt(static_cast<Real>(f_.samples()));
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
  bool is_over() const { return error_ || f_.is_spent() || f_.status() != Status::running; }

  // After the library's loop: its point, and what it states about its own success.
  Status end(Vector& theta, std::string_view words, Status by_its_test) {
    if (!is_over() && is_finite(theta) && theta != last_) report(theta);
    if (std::exchange(has_trial_, false)) f_.reject_step();
    if (error_) std::rethrow_exception(error_);
    theta = last_;
    f_.claim(words);
    if (f_.status() != Status::running) return f_.status();
    return f_.is_spent() ? Status::budget : by_its_test;
  }

 private:
  template <class Read>
  bool at(const double* theta, Read read) noexcept {
    if (is_over()) return false;
    try {
      const Eigen::Map<const Vector> wanted(theta, last_.size());
      if (!has_point_ || theta_ != wanted) {
        has_point_ = false;
        theta_ = wanted;
        f_.linearize(theta_, point_);
        point_.residual(residual_);
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
  bool has_point_ = false, has_trial_ = false;
  std::exception_ptr error_;
};

// The objection of methods that need as many residuals as unknowns.
inline std::string too_few_residuals(const OptionValues&, const Problem& problem) {
  return problem.residuals() < problem.unknowns() ? "it needs as many residuals as unknowns" : "";
}

}  // namespace isoline::optimizers
