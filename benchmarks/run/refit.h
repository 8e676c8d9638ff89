// Fits of all unknowns but one, from a fit nearby, as profiles of the likelihood need them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "optimizers/damped_least_squares.h"
#include "optimizers/differences.h"
#include "optimizers/meter.h"

namespace isoline::benchmarks {

// Levenberg-Marquardt steps, whose J begins with that of the nearest fit and follows by Broyden's
// formula (1965). Where it does not predict y, it is computed again, by differences where the
// problem has no derivatives of its own. Bounds that are equal hold the unknown.
class Refits {
 public:
  // θ of the fit, s², and the rise (S − S_min)/s² of the sum of squares S at an end of an interval.
  // The bounds of `problem` change with each fit.
  Refits(problems::Problem& problem, Vector fit, Real variance, Real rise_at_end);

  // θ (n) of the least S with that component as it is in `start`, −1: with none; nothing where P
  // has no value.
  std::optional<Vector> operator()(Index fixed, Vector theta);
  const Vector& fit() const { return known_[0].theta; }  // all unknowns fitted
  Real least() const { return least_; }                  // S there
  Vector deviations() const;                             // (n) there, with no unknown held
  Real sum_of_squares() const { return sum_; }           // of the last fit
  bool has_converged() const { return is_minimum_; }

 private:
  struct Known {
    Vector theta, y;
    Matrix J;
  };

  const Known& nearest_to(const Vector& theta) const;
  void hold(Index fixed, const Vector& theta);  // nothing: −1
  bool evaluate(const Vector& theta, optimizers::Linearization& at, Vector& residual);
  Known known_at(const Vector& theta, optimizers::Linearization& at);

  problems::Problem& problem_;
  problems::Bounds bounds_;  // its own; infinite where it has none
  problems::Start start_;
  std::unique_ptr<Trace> trace_ = std::make_unique<Trace>();
  optimizers::Meter f_;
  optimizers::DifferenceJacobian differences_;
  Real variance_, least_ = 0, rise_at_end_, sum_ = 0;
  bool is_exact_, is_minimum_ = true;
  std::vector<Known> known_;
  Vector steps_;  // of differences, (n): 0.3 standard deviations if all others are known
};

}  // namespace isoline::benchmarks
