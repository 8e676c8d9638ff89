// Fits of all unknowns but one, by few calls.
#include "benchmarks/run/refit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/decompose.h"
#include "core/differences.h"
#include "core/errors.h"

namespace isoline::benchmarks {

using optimizers::Linearization;

namespace {

// Whether J predicted a change of y to a third.
bool predicts(const Matrix& J, const Vector& moved, const Vector& change) {
  return (change - J * moved).squaredNorm() <= change.squaredNorm() / 9;
}

}  // namespace

Refits::Refits(problems::Problem& problem, Vector fit, Real variance, Real rise_at_end)
    : problem_(problem),
      start_(problem.start(), problem.standard_start()),
      f_(problem, {}, {Oracle::forward, Oracle::jacobian}, *trace_),
      variance_(variance),
      rise_at_end_(rise_at_end),
      is_exact_(problem.offers().contains(Oracle::jacobian) &&
                !problem.products().are_differences) {
  constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  const Vector none = Vector::Constant(fit.size(), kInfinity);
  bounds_ = problem.bounds() ? *problem.bounds() : problems::Bounds{-none, none};
  hold(-1, fit);
  fit = bounds_.nearest(fit);
  Linearization at;
  Vector r;
  require(evaluate(fit, at, r), "P has no value at the fit, where it had one before");
  least_ = r.squaredNorm();
  constexpr Real kFirst = 1e-3, kOfDeviation = 0.3, kNear = 3, kMostGrowth = 100;
  constexpr int kPasses = 6;
  steps_ = kFirst * fit.cwiseAbs().cwiseMax(sizes_of_unknowns(start_.standard));
  differences_.know(sizes_of_unknowns(fit), std::numeric_limits<Real>::epsilon());
  // Printed digits hide what a step far too small changes: until each has the length that it shows.
  for (int pass = 0; pass < kPasses; ++pass) {
    differences_.take_steps(steps_);
    if (!is_exact_) differences_.renew(f_, fit, pass == 0 ? "differences" : "central", at);
    const Vector shown = at.jacobian().colwise().norm().transpose().cwiseProduct(steps_) /
                         (kOfDeviation * std::sqrt(variance));
    steps_ = steps_.cwiseQuotient(shown.cwiseMax(1 / kMostGrowth));
    if (pass > 0 && shown.minCoeff() > 1 / kNear && shown.maxCoeff() < kNear) break;
  }
  known_.push_back(known_at(fit, at));
  (*this)(-1, fit);  // a run may have ended at its target
  if (!is_minimum_) return;
  least_ = sum_;
  known_.erase(known_.begin());
}

void Refits::hold(Index fixed, const Vector& theta) {
  problems::ProblemParts parts = std::move(problem_).parts();
  parts.bounds = bounds_;
  parts.start = start_;
  if (fixed >= 0) parts.bounds->lower[fixed] = parts.bounds->upper[fixed] = theta[fixed];
  problem_ = problems::Problem(std::move(parts));
}

bool Refits::evaluate(const Vector& theta, Linearization& at, Vector& r) {
  f_.linearize(theta, at);
  r = (at.y() - problem_.target()).reshaped();
  return r.allFinite();
}

Vector Refits::deviations() const {
  Svd svd;
  const Known& fit = known_[0];
  if (!thin_svd(fit.J * steps_.asDiagonal(), svd)) return steps_;
  const Matrix root = svd.Vt.transpose() * svd.sigma.cwiseInverse().asDiagonal();
  return std::sqrt(variance_) * steps_.cwiseProduct(root.rowwise().norm());
}

Refits::Known Refits::known_at(const Vector& theta, Linearization& at) {
  return {theta, at.y().reshaped(), at.jacobian()};
}

const Refits::Known& Refits::nearest_to(const Vector& theta) const {
  return *std::ranges::min_element(known_, {}, [&](const Known& known) {
    return (known.theta - theta).cwiseQuotient(steps_).squaredNorm();
  });
}

std::optional<Vector> Refits::operator()(Index fixed, Vector theta) {
  constexpr int kSteps = 50;
  constexpr Real kNone = 1e-24, kEnough = 5e-3;  // of s²: changes u = √(rise) by 0.1 %
  constexpr Real kNearEnd = 0.005;               // of t, as profiles have it
  constexpr Real kPoor = 10;                     // of the rise at an end, of a start
  hold(fixed, theta);
  const problems::Bounds bounds = *problem_.bounds();
  Linearization at, trial;
  optimizers::DampedLeastSquares squares;
  Vector step, change, r, r_trial;
  const Known& nearest = nearest_to(theta);
  const Vector apart = theta - nearest.theta;
  std::vector<Vector> starts;
  if (fixed >= 0 && apart.lpNorm<1>() == std::abs(apart[fixed])) {  // others follow by J
    at.set_jacobian(nearest.J);
    r = nearest.y - problem_.target().reshaped() + nearest.J * apart;
    squares.set(f_, at, theta, -r, "jacobian");
    if (squares.solve(kNone, "orthogonal", step, change)) starts.push_back(theta + step);
  }
  // J may lead astray, where a bound hides it; and a call may fail here and not nearby.
  const std::size_t beside = starts.size() + 1;
  for (const int shift : {0, 1, -1, 2}) starts.push_back(theta + shift * steps_);
  bool has_start = false;
  for (std::size_t i = 0; i < starts.size() && !(has_start && i >= beside); ++i) {
    const Vector from = bounds.nearest(starts[i]);
    if (!evaluate(from, trial, r_trial)) continue;
    if (has_start && r_trial.squaredNorm() >= r.squaredNorm()) continue;
    has_start = true;
    theta = from;
    std::swap(at, trial);
    r = r_trial;
    if (r.squaredNorm() - least_ <= kPoor * rise_at_end_ * variance_) break;
  }
  if (!has_start) return std::nullopt;
  const Vector D = steps_.cwiseInverse();
  bool is_fresh = is_exact_, is_trusted = true;
  if (!is_exact_) {
    is_trusted = predicts(nearest.J, theta - nearest.theta, at.y().reshaped() - nearest.y);
    differences_.know(nearest.theta, nearest.y, nearest.J);
    differences_.update(theta, D, at);
  }
  Real damping = 1e-6;
  int rejected = 0;
  is_minimum_ = false;
  for (int i = 0; i < kSteps; ++i) {
    squares.set(f_, at, theta, -r, "jacobian");
    if (!squares.solve(kNone, "orthogonal", step, change)) break;
    const Real promised = change.squaredNorm() / variance_;
    const Real u = std::sqrt(std::max<Real>(r.squaredNorm() - least_, 0) / variance_),
               t = std::sqrt(rise_at_end_);
    const bool is_at_end = std::abs(u - t) <= kNearEnd * t,  // to be sure of
        is_near = promised <= 10 * kEnough;
    if ((promised <= kEnough && (is_fresh || (is_trusted && !is_at_end))) ||
        rejected > (is_near ? 3 : 12)) {
      is_minimum_ = is_near;
      break;
    }
    if (!is_fresh && (promised <= kEnough || (!is_trusted && rejected != 1))) {
      differences_.renew(f_, theta, "central", at);
      is_fresh = true;
      damping = std::min<Real>(damping, 1e-3);
      continue;
    }
    squares.solve(damping, "orthogonal", step, change);
    const Vector to = bounds.nearest(theta + step);
    const bool has_value = evaluate(to, trial, r_trial);
    const bool is_better = has_value && r_trial.squaredNorm() < r.squaredNorm();
    is_trusted = has_value && predicts(at.jacobian(), to - theta, r_trial - r);
    if (is_better) {
      theta = to;
      std::swap(at, trial);
      std::swap(r, r_trial);
      if (!is_exact_) differences_.update(theta, D, at);
      rejected = 0;
      damping /= 5;
      is_fresh = is_exact_;
    } else {
      if (has_value && !is_fresh) differences_.learn(to, trial.y().reshaped(), D, at);
      ++rejected;
      damping = std::max<Real>(10 * damping, 1e-3);
    }
  }
  sum_ = r.squaredNorm();
  if (is_minimum_) known_.push_back(known_at(theta, at));
  return theta;
}

}  // namespace isoline::benchmarks
