// Fits of all unknowns but one, by few calls.
#include "benchmarks/run/refit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.h"

namespace isoline::benchmarks {

namespace {

constexpr Real kOfDeviation = 0.3, kNearEnd = 0.005;  // of t, as profiles have it

}  // namespace

Refits::Refits(const problems::Problem& problem, Vector fit, Real variance, Real rise_at_end)
    : problem_(problem), variance_(variance), rise_at_end_(rise_at_end) {
  fit = inside(fit);
  const std::optional<Vector> r = residual(fit);
  require(r.has_value(), "P has no value at the fit, where it had one before");
  least_ = r->squaredNorm();
  constexpr Real kFirst = 1e-3, kLeastSize = 1e-3;
  steps_ = kFirst * fit.cwiseAbs().cwiseMax(kLeastSize);
  J_ = Matrix::Zero(r->size(), fit.size());
  for (int i = 0; i < 2; ++i) {
    compute(J_, fit, *r, -1);
    for (Index j = 0; j < fit.size(); ++j)
      if (const Real slope = J_.col(j).norm(); slope > 0)
        steps_[j] = kOfDeviation * std::sqrt(variance_) / slope;
  }
  known_.emplace_back(fit, *r);
  if (const auto better = fitted(-1, fit)) fit = *better;  // a run may have ended at its target
  least_ = sum_;
  known_.assign({{fit, *residual(fit)}});
}

Vector Refits::inside(const Vector& theta) const {
  return problem_.bounds() ? problem_.bounds()->nearest(theta) : theta;
}

std::optional<Vector> Refits::residual(const Vector& theta) {
  try {
    problem_.forward(theta, at_);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  Vector r = (at_.y - problem_.target()).reshaped();
  return std::isfinite(r.squaredNorm()) ? std::optional(std::move(r)) : std::nullopt;
}

// By central differences inside the bounds, of one side where the other fails.
Vector Refits::column(const Vector& theta, Index j, Real step, const Vector& r) {
  for (const Real size : {step, step / 2, 2 * step}) {
    std::vector<std::pair<Real, Vector>> ends;
    for (const int sign : {1, -1}) {
      Vector moved = theta;
      moved[j] += sign * size;
      moved = inside(moved);
      if (moved[j] == theta[j]) continue;
      if (auto there = residual(moved)) ends.emplace_back(moved[j], *std::move(there));
    }
    if (ends.size() == 1) ends.emplace_back(theta[j], r);
    if (ends.size() == 2)
      return (ends[0].second - ends[1].second) / (ends[0].first - ends[1].first);
  }
  return Vector::Zero(r.size());
}

void Refits::compute(Matrix& J, const Vector& theta, const Vector& r, Index fixed) {
  const problems::Products has = problem_.products();
  if ((has.has_pullback || has.has_pushforward) && !has.are_differences) {
    if (residual(theta)) problem_.jacobian(J, at_);
    return;
  }
  for (Index j = 0; j < theta.size(); ++j)
    if (j != fixed) J.col(j) = column(theta, j, steps_[j], r);
}

bool Refits::update(Matrix& J, const Vector& moved, const Vector& change) const {
  const Vector miss = change - J * moved, scaled = moved.cwiseQuotient(steps_);
  if (scaled.squaredNorm() > 0)
    J += miss * scaled.cwiseQuotient(steps_).transpose() / scaled.squaredNorm();
  return miss.squaredNorm() <= change.squaredNorm() / 9;
}

bool Refits::is_at(const Vector& theta, Index j, bool upper) const {
  const problems::Bounds* const box = problem_.bounds();
  return box && (upper ? theta[j] >= box->upper[j] : theta[j] <= box->lower[j]);
}

std::pair<Vector, Real> Refits::step(const Vector& theta, const Vector& r, Index fixed,
                                     const Matrix& J, Real damping) const {
  const Vector gradient = J.transpose() * r, size = J.colwise().norm();
  std::vector<Index> free;
  for (Index j = 0; j < theta.size(); ++j)
    if (j != fixed && size[j] > 0 && !is_at(theta, j, gradient[j] < 0)) free.push_back(j);
  Vector moved = Vector::Zero(theta.size());
  if (free.empty()) return {moved, 0};
  const Vector of_free = size(free), b = -Vector(gradient(free)).cwiseQuotient(of_free);
  const Matrix A = J(Eigen::all, free) * of_free.cwiseInverse().asDiagonal();
  const auto solved = [&](Real more) -> Vector {
    Matrix normal = A.transpose() * A;
    normal.diagonal().array() += more;
    return normal.ldlt().solve(b);
  };
  moved(free) = solved(damping).cwiseQuotient(of_free);
  constexpr Real kRounding = 1e-12;
  return {moved, solved(kRounding).dot(b)};
}

const std::pair<Vector, Vector>& Refits::nearest_to(const Vector& theta) const {
  return *std::ranges::min_element(known_, {}, [&](const auto& known) {
    return (known.first - theta).cwiseQuotient(steps_).squaredNorm();
  });
}

std::optional<Vector> Refits::operator()(Index fixed, const Vector& start, int halvings) {
  std::optional<Vector> found = fitted(fixed, start);
  if (!found || is_minimum_ || halvings == 0) return found;
  const Real value = start[fixed];
  const auto& near = *std::ranges::min_element(
      known_, {}, [&](const auto& known) { return std::abs(known.first[fixed] - value); });
  const Vector from = near.first;
  Vector between = from;
  between[fixed] = (from[fixed] + value) / 2;
  const std::optional<Vector> halfway = (*this)(fixed, between, halvings - 1);
  if (!halfway || !is_minimum_) return found;
  Vector again = inside(2 * *halfway - from);
  again[fixed] = value;
  return (*this)(fixed, again, halvings - 1);
}

std::optional<Vector> Refits::fitted(Index fixed, Vector theta) {
  const auto keep = [&, value = fixed < 0 ? 0 : theta[fixed]](Vector& at) {
    if (fixed >= 0) at[fixed] = value;
  };
  std::optional<Vector> first;
  for (const int shift : {0, 1, -1, 2}) {  // a call may fail here and not nearby
    Vector near = inside(theta + shift * steps_);
    keep(near);
    if (!(first = residual(near))) continue;
    theta = near;
    break;
  }
  if (!first) return std::nullopt;
  Vector r = *std::move(first);
  const Real enough = 5e-3 * variance_;  // of S: changes u = √(rise) by 0.1 %
  const auto is_at_end = [&] {           // to be sure of
    const Real u = std::sqrt(std::max<Real>(r.squaredNorm() - least_, 0) / variance_),
               t = std::sqrt(rise_at_end_);
    return std::abs(u - t) <= kNearEnd * t;
  };
  Matrix J = J_;
  Real damping = 1e-6;
  int rejected = 0;
  const auto& [nearest, r_there] = nearest_to(theta);
  Matrix across = J;
  bool is_fresh = false, is_trusted = update(across, theta - nearest, r - r_there);
  constexpr int kSteps = 50;
  is_minimum_ = false;
  for (int i = 0; i < kSteps; ++i) {
    const auto [move, promised] = step(theta, r, fixed, J, damping);
    const bool is_near = promised <= 10 * enough;
    if ((promised <= enough && (is_fresh || (is_trusted && !is_at_end()))) ||
        rejected > (is_near ? 3 : 12)) {
      is_minimum_ = is_near;
      break;
    }
    if (!is_fresh && (promised <= enough || (!is_trusted && rejected != 1))) {
      compute(J, theta, r, fixed);
      is_fresh = true;
      damping = std::min<Real>(damping, 1e-3);
      continue;
    }
    Vector trial = inside(theta + move);
    keep(trial);
    std::optional<Vector> there = residual(trial);
    const bool is_better = there && there->squaredNorm() < r.squaredNorm();
    if (there) {
      Matrix updated = J;
      is_trusted = update(updated, trial - theta, *there - r);
      if (is_better || !is_fresh) J = updated;
    } else {
      is_trusted = false;
    }
    if (is_better) {
      theta = trial;
      r = *std::move(there);
      rejected = 0;
      damping /= 5;
      is_fresh = false;
    } else {
      ++rejected;
      damping = std::max<Real>(10 * damping, 1e-3);
    }
  }
  sum_ = r.squaredNorm();
  if (is_minimum_ && fixed >= 0) known_.emplace_back(theta, r);
  return theta;
}

}  // namespace isoline::benchmarks
