// J of residuals without derivatives, for methods of least squares: by differences whose steps
// follow from the noise of the calls, with rank-one updates between; Broyden (1965), which keep
// what J knows of the steps before; Gay, Schnabel (1978). The noise is measured once, by three to
// eight calls or by ECNoise's tables, and is at least rounding. M₂ of h = 8^¼ √(ε_f/M₂), a bound on
// the second derivative along an unknown, is ‖y‖ over the square of the unknown's size; Moré, Wild
// (2012), ACM TOMS 38.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/archive.h"
#include "core/differences.h"
#include "core/options.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

inline const Choices kJacobians{"exact", "differences", "central", "ecnoise"};
inline constexpr const char* kJacobianHelp =
    "exact: as the problem offers it; differences, central: by forward or central differences of "
    "r, which cost n or 2n forward solves, with steps that follow from the noise of y, which three to eight "
    "calls at the start measure; ecnoise: by forward differences with the noise by ECNoise, 8 to 29 "
    "calls at the start";

class DifferenceJacobian {
 public:
  // J at `at`, the point of the last linearization, θ: renewed, or updated by this step. `kind`: of
  // kJacobians.
  void renew(Meter& f, const Vector& theta, std::string_view kind, Linearization& at) {
    const bool is_central = kind == "central";
    Vector line, slope;  // of y along the line, which the first J needs not measure again
    if (noise_ == 0) measure(f, theta, kind == "ecnoise", at, line, slope);
    const Index n = theta.size();
    Index known = n;  // the column that follows from the slope
    if (slope.size() > 0 && !is_central && !line.isZero(0) && given_.steps.empty())
      line.cwiseQuotient(sizes_).cwiseAbs().maxCoeff(&known);
    y_ = at.y().reshaped();
    J_.setZero(y_.size(), n);
    if (!y_.allFinite()) {  // there is nothing to compare other calls with
      J_.setConstant(std::numeric_limits<Real>::quiet_NaN());
      theta_ = theta;
      is_fresh_ = true;
      at.set_jacobian(J_);
      return;
    }
    const Real step = is_central ? central_step(noise_) : forward_step(noise_);
    std::vector<std::array<Real, 2>> offsets;
    Matrix points(n, is_central ? 2 * n : n);
    Index calls = 0;
    for (Index j = 0; j < n; ++j) {
      const Room room = room_of(f, theta, j);
      const Real h = step_of(theta, j, step);
      offsets.push_back(difference_offsets(h, is_central, room.up, room.down));
      if (j == known) continue;
      for (const Real offset : offsets.back()) {
        if (offset == 0) continue;
        points.col(calls) = theta;
        points(j, calls++) = theta[j] + offset;
      }
    }
    f.announce(points.leftCols(calls));
    for (Index j = 0; j < n; ++j)
      if (j != known) J_.col(j) = column(f, theta, j, offsets[static_cast<std::size_t>(j)]);
    if (known < n) J_.col(known) = (slope - J_ * line) / line[known];
    constexpr Real kLarger = 30;  // an unknown that does not show is tried once more
    for (Index j = 0; j < n; ++j) {
      const Real h = step_of(theta, j, step);
      if (shows(j, h)) continue;
      const Room room = room_of(f, theta, j);
      J_.col(j) =
          column(f, theta, j, difference_offsets(kLarger * h, is_central, room.up, room.down));
    }
    columns_ = J_.colwise().norm();
    theta_ = theta;
    is_fresh_ = true;
    at.set_jacobian(J_);
    is_central_ = is_central;
    f.know_jacobian(theta, J_,
                    {.noise = noise_,
                     .step = given_.steps.empty() ? step : std::nan(""),
                     .is_central = is_central});
    f.recall_paid_loss(at.loss());
  }
  // Broyden's update at an evaluated point that θ moves to: J moves least, in the norm of ‖J D⁻¹‖,
  // so that J Δθ = Δy, and without noise J s stays for the last steps s, as many as leave
  // enough of Δθ beside them.
  void update(const Vector& theta, const Vector& D, Linearization& at) {
    learn(theta, at.y().reshaped(), D);
    theta_ = theta;
    y_ = at.y().reshaped();
    at.set_jacobian(J_);
  }
  // The same by a point that was evaluated and left again: `at` is that of the last J.
  void learn(const Vector& theta, const Vector& y, const Vector& D, Linearization& at) {
    learn(theta, y, D);
    at.set_jacobian(J_);
  }
  // In place of those that follow from the noise. Absolute ones are in the problem's own units.
  void take_steps(const std::string& text, const Meter& f) {
    given_ = given_steps(text);
    of_ = &f.problem();
  }
  void take_steps(const Vector& absolute) {  // in the units of θ
    given_ = {.steps = {absolute.begin(), absolute.end()}, .are_absolute = true};
    of_ = nullptr;
  }
  // As they were near θ.
  void know(const Vector& theta, const Vector& y, const Matrix& J) {
    theta_ = theta;
    y_ = y;
    J_ = J;
  }
  // The sizes of the unknowns, (n), in place of those of the first θ; and the noise, as another one
  // has measured it near θ, or 0.
  void know(const Vector& sizes, Real noise) {
    sizes_ = sizes;
    noise_ = noise;
  }
  bool is_fresh() const { return is_fresh_; }  // not yet updated
  bool is_central() const { return is_central_; }
  Real noise() const { return noise_; }  // of y in a call, relative to ‖y‖
  bool is_noisy() const { return noise_ > std::numeric_limits<Real>::epsilon(); }
  // An unknown may end far smaller than it starts, and y bend as far as its new size.
  Real size_of(const Vector& theta, Index j) const {
    constexpr Real kLeast = 1e-3;  // of its size at the start
    return std::max(std::abs(theta[j]), (is_noisy() ? 1 : kLeast) * sizes_[j]);
  }
  void persist(Archive& archive) {
    archive(J_, steps_, columns_, theta_, y_, sizes_, noise_, is_fresh_, is_central_);
  }

 private:
  Real step_of(const Vector& theta, Index j, Real otherwise) const {
    Real size = size_of(theta, j);
    if (given_.steps.empty() && columns_.size() > 0)
      size = size_for_steps(size, columns_[j], y_.norm());
    if (of_ == nullptr) return given_.of(j, theta.size(), size, otherwise);
    return of_->given_step(given_, theta, j, size, otherwise);
  }
  static Room room_of(const Meter& f, const Vector& theta, Index j) {
    const Bounds* const bounds = f.bounds();
    if (bounds == nullptr) return {};
    return {.up = bounds->upper[j] - theta[j], .down = theta[j] - bounds->lower[j]};
  }
  // Whether the column is more than noise.
  bool shows(Index j, Real h) const { return J_.col(j).norm() * h > 2 * noise_ * y_.norm(); }

  void learn(const Vector& theta, const Vector& y, const Vector& D) {
    constexpr Real kNew = 0.25;  // of a step: less that is new follows from errors of the others
    constexpr Real kDependent = 1e-3;  // of a step that is kept
    const Vector moved = theta - theta_;
    const Index n = moved.size();
    if (is_fresh_ || steps_.rows() != n) steps_.resize(n, 0);
    Vector along = D.cwiseProduct(moved);
    const Real least = kNew * along.norm();
    const Index most = is_noisy() ? 0 : steps_.cols();  // noise in Δy grows by what is left out
    Matrix Q(n, most);                                  // of the steps to keep, orthonormal
    Index kept = 0;
    for (; kept < most; ++kept) {
      Vector q = D.cwiseProduct(steps_.col(kept));
      const Real shortest = kDependent * q.norm();
      q -= Q.leftCols(kept) * (Q.leftCols(kept).transpose() * q);
      if (!(q.norm() > shortest)) break;
      Q.col(kept) = q.normalized();
      const Vector rest = along - Q.col(kept).dot(along) * Q.col(kept);
      if (!(rest.norm() > least)) break;
      along = rest;
    }
    const Vector dual = D.cwiseProduct(along);
    const Real squares = moved.dot(dual);
    if (squares > 0) {
      J_ += (y - y_ - J_ * moved) * (dual / squares).transpose();
      Matrix steps(n, kept + 1);
      steps << moved, steps_.leftCols(kept);
      steps_ = std::move(steps);
    }
    is_fresh_ = false;
  }
  // Along a line through θ, inside the bounds.
  void measure(Meter& f, const Vector& theta, bool by_tables, Linearization& at, Vector& line,
               Vector& slope) {
    if (sizes_.size() == 0) sizes_ = sizes_of_unknowns(theta);
    const Bounds* const bounds = f.bounds();
    line = line_inside(theta, sizes_, bounds ? &bounds->lower : nullptr,
                       bounds ? &bounds->upper : nullptr);
    const auto y = [&](Real t) -> Vector {
      f.linearize(theta + t * line, other_);
      return other_.y().reshaped();
    };
    if (!by_tables) {
      Matrix points = theta.replicate(1, kNoiseSteps.size());
      for (std::size_t i = 0; i < kNoiseSteps.size(); ++i)
        points.col(static_cast<Index>(i)) += kNoiseSteps[i] * line;
      f.announce(points);
      noise_ = noise_of_calls(at.y().reshaped(), y, f.problem().factors_of_data(), &slope);
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
  Matrix steps_;                  // (n, any), since then, the newest first: J knows Δy of each
  Vector columns_;                // (n), their norms when last measured, or empty
  Vector theta_, moved_, sizes_;  // (n)
  Vector y_;                      // (m), at θ
  Real noise_ = 0;                // of y in a call, relative to ‖y‖; 0: it is not known
  bool is_fresh_ = false, is_central_ = false;
  Linearization other_;
  GivenSteps given_;
  const Problem* of_ = nullptr;  // in whose units they are; nullptr: those of θ
};

}  // namespace isoline::optimizers
