// J of residuals without derivatives, for methods of least squares: by differences whose steps
// follow from the noise of the calls, with rank-one updates between; Broyden (1965). The noise is
// that of a repeated call at the start, or that of ECNoise's tables, at least rounding. M₂ of h =
// 8^¼ √(ε_f/M₂), a bound on the second derivative along an unknown, is ‖r‖ over the square of the
// unknown's size; Moré, Wild (2012), ACM TOMS 38.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/archive.h"
#include "core/differences.h"
#include "core/options.h"
#include "core/random.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

inline const Choices kJacobians{"exact", "differences", "central", "ecnoise"};
inline constexpr const char* kJacobianHelp =
    "exact: as the problem offers it; differences, central: by forward or central differences of "
    "r, which cost n or 2n forward solves, with the noise of a repeated call; ecnoise: by forward "
    "differences with the noise by ECNoise, 8 to 29 calls at the start, which also sees noise that "
    "repeats, as of iterative solvers";

class DifferenceJacobian {
 public:
  // J at `at`, the point of the last linearization, θ: renewed, or updated by this step. `kind`: of
  // kJacobians.
  void renew(Meter& f, const Vector& theta, std::string_view kind, Linearization& at) {
    const bool is_central = kind == "central";
    if (sizes_.size() == 0) measure(f, theta, kind == "ecnoise", at);
    const Index n = theta.size();
    const Matrix y = at.y();
    J_.resize(y.size(), n);
    moved_ = theta;
    Vector h(n);
    const Index calls = is_central ? 2 : 1;
    Matrix points = theta.replicate(1, calls * n);
    for (Index j = 0; j < n; ++j) {
      const Real size = std::max(std::abs(theta[j]), sizes_[j]);
      h[j] = size * (is_central ? central_step(noise_) : forward_step(noise_));
      if (const Bounds* bounds = f.bounds(); bounds && theta[j] + h[j] > bounds->upper[j])
        h[j] = -h[j];
      points(j, calls * j) = theta[j] + h[j];
      if (is_central) points(j, calls * j + 1) = theta[j] - h[j];
    }
    f.announce(points);
    for (Index j = 0; j < n; ++j) J_.col(j) = column(f, theta, j, h[j], is_central, y);
    theta_ = theta;
    y_ = y.reshaped();
    is_fresh_ = true;
    at.set_jacobian(J_);
  }
  // Broyden's update: J moves least so that J Δθ = Δy.
  void update(const Vector& theta, Linearization& at) {
    const Vector moved = theta - theta_;
    const Real squares = moved.squaredNorm();
    if (squares > 0)
      J_ += (Vector(at.y().reshaped()) - y_ - J_ * moved) * (moved / squares).transpose();
    theta_ = theta;
    y_ = at.y().reshaped();
    is_fresh_ = false;
    at.set_jacobian(J_);
  }
  bool is_fresh() const { return is_fresh_; }  // not yet updated
  bool is_noisy() const { return noise_ > std::numeric_limits<Real>::epsilon(); }
  bool has_jacobian() const { return J_.size() > 0; }
  void persist(Archive& archive) { archive(J_, theta_, y_, sizes_, noise_, is_fresh_); }

 private:
  // The noise of r relative to it, of two calls at the start or by ECNoise along a line through it.
  void measure(Meter& f, const Vector& theta, bool by_tables, Linearization& at) {
    sizes_ = sizes_of_unknowns(theta);
    const auto y = [&](const Vector& point) -> Vector {
      f.linearize(point, other_);
      return other_.y().reshaped();
    };
    Real noise = 0;
    if (by_tables) {
      RandomStream stream(0, "", "noise of values");
      const Vector line = sizes_.cwiseProduct(stream.uniform_vector(theta.size(), -1, 1));
      noise = noise_of_values([&](Real t) { return y(theta + t * line); }).norm();
    } else {
      noise = (y(theta) - at.y().reshaped()).norm();
    }
    const Real level = noise / (other_.y() - f.target()).norm() / (by_tables ? 1 : std::sqrt(2.0));
    noise_ = std::max(std::isfinite(level) ? level : 0, std::numeric_limits<Real>::epsilon());
  }
  Vector column(Meter& f, const Vector& theta, Index j, Real h, bool is_central, const Matrix& y) {
    moved_[j] = theta[j] + h;
    const Real ahead = moved_[j];  // what rounding leaves of the step
    f.linearize(moved_, other_);
    Vector difference = other_.y().reshaped();
    Real length = ahead - theta[j];
    if (is_central) {
      moved_[j] = theta[j] - h;
      f.linearize(moved_, other_);
      difference -= other_.y().reshaped();
      length = ahead - moved_[j];
    } else {
      difference -= y.reshaped();
    }
    moved_[j] = theta[j];
    return difference / length;
  }
  Matrix J_;                      // (m, n)
  Vector theta_, moved_, sizes_;  // (n)
  Vector y_;                      // (m), at θ
  Real noise_ = 0;                // of r in a call, relative to it
  bool is_fresh_ = false;
  Linearization other_;
};

}  // namespace isoline::optimizers
