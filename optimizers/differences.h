// J of residuals without derivatives, for methods of least squares: by differences whose steps
// follow from the noise of the calls, with rank-one updates between; Broyden (1965). The noise is
// measured once, by five calls or by ECNoise's tables, and is at least rounding. M₂ of h = 8^¼
// √(ε_f/M₂), a bound on the second derivative along an unknown, is ‖y‖ over the square of the
// unknown's size; Moré, Wild (2012), ACM TOMS 38.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "core/archive.h"
#include "core/differences.h"
#include "core/options.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

inline const Choices kJacobians{"exact", "differences", "central", "ecnoise"};
inline constexpr const char* kJacobianHelp =
    "exact: as the problem offers it; differences, central: by forward or central differences of "
    "r, which cost n or 2n forward solves, with steps that follow from the noise of y, which five "
    "calls at the start measure; ecnoise: by forward differences with the noise by ECNoise, 8 to 29 "
    "calls at the start";

class DifferenceJacobian {
 public:
  // J at `at`, the point of the last linearization, θ: renewed, or updated by this step. `kind`: of
  // kJacobians.
  void renew(Meter& f, const Vector& theta, std::string_view kind, Linearization& at) {
    const bool is_central = kind == "central";
    if (sizes_.size() == 0) measure(f, theta, kind == "ecnoise", at);
    const Index n = theta.size();
    y_ = at.y().reshaped();
    J_.setZero(y_.size(), n);
    const Real step = is_central ? central_step(noise_) : forward_step(noise_);
    std::vector<std::array<Real, 2>> offsets;
    Matrix points(n, is_central ? 2 * n : n);
    Index calls = 0;
    for (Index j = 0; j < n; ++j) {
      const Room room = room_of(f, theta, j);
      const Real h = step * size_of(theta, j);
      offsets.push_back(difference_offsets(h, is_central, room.up, room.down));
      for (const Real offset : offsets.back()) {
        if (offset == 0) continue;
        points.col(calls) = theta;
        points(j, calls++) = theta[j] + offset;
      }
    }
    f.announce(points.leftCols(calls));
    for (Index j = 0; j < n; ++j)
      J_.col(j) = column(f, theta, j, offsets[static_cast<std::size_t>(j)]);
    constexpr Real kLarger = 30;  // an unknown that does not show is tried once more
    for (Index j = 0; j < n; ++j) {
      const Real h = step * size_of(theta, j);
      if (shows(j, h)) continue;
      const Room room = room_of(f, theta, j);
      J_.col(j) =
          column(f, theta, j, difference_offsets(kLarger * h, is_central, room.up, room.down));
    }
    theta_ = theta;
    is_fresh_ = true;
    at.set_jacobian(J_);
    f.know_jacobian(theta, J_, noise_);
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
  Real noise() const { return noise_; }        // of y in a call, relative to ‖y‖
  bool is_noisy() const { return noise_ > std::numeric_limits<Real>::epsilon(); }
  bool has_jacobian() const { return J_.size() > 0; }
  void persist(Archive& archive) { archive(J_, theta_, y_, sizes_, noise_, is_fresh_); }

 private:
  Real size_of(const Vector& theta, Index j) const {
    return std::max(std::abs(theta[j]), sizes_[j]);
  }
  static Room room_of(const Meter& f, const Vector& theta, Index j) {
    const Bounds* const bounds = f.bounds();
    if (bounds == nullptr) return {};
    return {.up = bounds->upper[j] - theta[j], .down = theta[j] - bounds->lower[j]};
  }
  // Whether the column is more than noise.
  bool shows(Index j, Real h) const { return J_.col(j).norm() * h > 2 * noise_ * y_.norm(); }

  // Along a line through θ, inside the bounds.
  void measure(Meter& f, const Vector& theta, bool by_tables, Linearization& at) {
    sizes_ = sizes_of_unknowns(theta);
    const Bounds* const bounds = f.bounds();
    const Vector line = line_inside(theta, sizes_, bounds ? &bounds->lower : nullptr,
                                    bounds ? &bounds->upper : nullptr);
    const auto y = [&](Real t) -> Vector {
      f.linearize(theta + t * line, other_);
      return other_.y().reshaped();
    };
    if (!by_tables) {
      noise_ = noise_of_calls(at.y().reshaped(), y);
      return;
    }
    const Real level = noise_of_values(y).norm() / at.y().norm();
    noise_ = std::max(std::isfinite(level) ? level : 0, std::numeric_limits<Real>::epsilon());
  }
  Vector column(Meter& f, const Vector& theta, Index j, const std::array<Real, 2>& offsets) {
    moved_ = theta;
    return quotient_of_calls(offsets, room_of(f, theta, j), y_, [&](Real& t) -> Vector {
      moved_[j] = theta[j] + t;
      t = moved_[j] - theta[j];  // what rounding leaves of it
      f.linearize(moved_, other_);
      return other_.y().reshaped();
    });
  }

  Matrix J_;                      // (m, n)
  Vector theta_, moved_, sizes_;  // (n)
  Vector y_;                      // (m), at θ
  Real noise_ = 0;                // of y in a call, relative to ‖y‖
  bool is_fresh_ = false;
  Linearization other_;
};

}  // namespace isoline::optimizers
