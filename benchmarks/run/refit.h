// Fits of all unknowns but one, from a fit nearby, as profiles of the likelihood need them.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "problems/problem.h"

namespace isoline::benchmarks {

// Levenberg-Marquardt steps, whose J begins with that of the fit and follows by Broyden's formula
// (1965). Where it does not predict r, it is computed again, by differences where the problem has
// no derivatives of its own.
class Refits {
 public:
  // θ of the fit, s², and the rise (S − S_min)/s² of the sum of squares S at an end of an interval.
  Refits(const problems::Problem& problem, Vector fit, Real variance, Real rise_at_end);

  // θ (n) of the least S with that component as it is in `start`; nothing where P has no value. By
  // way of values halfway to a known fit where the steps do not end.
  std::optional<Vector> operator()(Index fixed, const Vector& start, int halvings = 4);
  const Vector& fit() const { return known_[0].first; }  // all unknowns fitted
  Real least() const { return least_; }                  // S there
  Real sum_of_squares() const { return sum_; }           // at the last θ
  bool has_converged() const { return is_minimum_; }     // the last time

 private:
  std::optional<Vector> fitted(Index fixed, Vector theta);
  const std::pair<Vector, Vector>& nearest_to(const Vector& theta) const;
  std::optional<Vector> residual(const Vector& theta);
  Vector column(const Vector& theta, Index j, Real step, const Vector& r);
  void compute(Matrix& J, const Vector& theta, const Vector& r, Index fixed);
  // The step over the unknowns that no bound holds, and the decrease of S that it has undamped.
  std::pair<Vector, Real> step(const Vector& theta, const Vector& r, Index fixed, const Matrix& J,
                               Real damping) const;
  // J after a step; whether it predicted r to a third.
  bool update(Matrix& J, const Vector& moved, const Vector& change) const;
  Vector inside(const Vector& theta) const;
  bool is_at(const Vector& theta, Index j, bool upper) const;

  const problems::Problem& problem_;
  problems::Point at_;
  Real variance_, least_ = 0, rise_at_end_, sum_ = 0;
  bool is_minimum_ = true;
  Matrix J_;                                      // at the fit, (m, n)
  std::vector<std::pair<Vector, Vector>> known_;  // θ and r of the fits so far
  Vector steps_;  // of differences, (n): 0.3 standard deviations if all others are known
};

}  // namespace isoline::benchmarks
