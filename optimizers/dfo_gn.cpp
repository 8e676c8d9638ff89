// Derivative-free Gauss-Newton: the linear model r + J d of all residuals interpolates them at
// n + 1 points, d minimizes ‖r + J d‖ over ‖d‖ ≤ Δ, and the new point replaces one of the others;
// Cartis, Roberts (2019), Math. Prog. Comp. 11, 631–674. A lower bound ρ of Δ follows Powell
// (2009). Here, a repeated call at the start tells whether calls are noisy. Without noise, the
// first points are near to each other and Δ is large. With noise, the points keep a distance that
// grows with it, and the method restarts where the losses of all points are within the noise: as in
// Cartis, Fiala, Marteau, Roberts (2019), ACM TOMS 45:32, most points stay. Before a restart, r and
// J come from fits to all calls within a radius, as long as the misfit of the fit is that of the
// noise. All points stay within the bounds, as those of DFO-LS do (same authors).
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/archive.h"
#include "core/array.h"
#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();

// Lengths and scores that differ by less are equal: Δ and ρ are multiples of each other, points lie
// on the boundary of the trust region, and rounding would otherwise decide between them.
constexpr Real kEqual = 1e-6;

// The first of the largest.
Index first_largest(const Vector& values) {
  const Real enough = (1 - kEqual) * values.maxCoeff();
  Index i = 0;
  while (i + 1 < values.size() && !(values[i] >= enough)) ++i;
  return i;
}

// min ‖r + J d‖ over ‖d‖ ≤ Δ: d = −V (Σ² + μ)⁻¹ Σ Uᵀr with the least μ ≥ 0, by Newton's method on
// 1/Δ − 1/‖d‖; Moré, Sorensen (1983).
Vector trust_region_step(const Svd& J, const Vector& r, Real radius) {
  constexpr int kMost = 100;
  constexpr Real kAccurate = 1e-2, kLow = 1e-3;  // of ‖d‖; a first share of the largest μ
  constexpr Real kRounding = 1e-11;  // of σ₁: differences of r over ρ leave such σ of a singular J
  const Vector along = J.sigma.cwiseProduct(J.U.transpose() * r);
  const Vector squares = J.sigma.cwiseAbs2();
  const Real least = kRounding * kRounding * squares.maxCoeff();
  Vector c = (squares.array() > least).select(along.cwiseQuotient(squares), 0);
  if (!(c.norm() <= radius)) {
    Real low = 0, high = along.norm() / radius, mu = kLow * high;
    for (int i = 0; i < kMost; ++i) {
      const Vector damped = squares.array() + mu;
      c = along.cwiseQuotient(damped);
      const Real length = c.norm();
      if (std::abs(length - radius) <= kAccurate * radius) break;
      (length > radius ? low : high) = mu;
      mu +=
          length * length / c.cwiseAbs2().cwiseQuotient(damped).sum() * (length - radius) / radius;
      if (!(mu > low && mu < high)) mu = low > 0 ? std::sqrt(low * high) : kLow * high;
    }
    c *= std::min<Real>(1, radius / c.norm());
  }
  return -(J.Vt.transpose() * c);
}

// The same with x + d within the bounds: the better of the projected gradient and of d in the
// unknowns that no bound stops.
Vector trust_region_step(const Svd& svd, const Matrix& J, const Vector& r, Real radius,
                         const Vector& x, const Bounds* bounds) {
  const Vector whole = trust_region_step(svd, r, radius);
  if (bounds == nullptr || bounds->hold(x + whole)) return whole;
  const Index n = x.size();
  Vector best = Vector::Zero(n), held = best;
  Real most = 0;
  const auto offer = [&](const Vector& to) {
    const Vector d = bounds->nearest(to) - x, Jd = J * d;
    const Real gain = -(r.dot(Jd) + 0.5 * Jd.squaredNorm());
    if (gain > most) {
      most = gain;
      best = d;
    }
  };
  const Vector g = J.transpose() * r;
  constexpr int kHalvings = 30;
  for (int i = 0; i < kHalvings; ++i) offer(x - std::ldexp(radius / g.norm(), -i) * g);
  std::vector<Index> free;
  for (Index i = 0; i < n; ++i)
    if (!bounds->is_active(x, g, i)) free.push_back(i);
  while (!free.empty() && held.norm() < radius) {
    Svd of_free;
    if (!thin_svd(J(Eigen::all, free), of_free)) break;
    Vector to = x + held;
    to(free) +=
        trust_region_step(of_free, r + J * held, std::sqrt(radius * radius - held.squaredNorm()));
    offer(to);
    const Vector nearest = bounds->nearest(to);
    const auto stopped =
        std::ranges::stable_partition(free, [&](Index i) { return to[i] == nearest[i]; });
    if (stopped.empty()) break;
    for (const Index i : stopped) held[i] = nearest[i] - x[i];
    free.erase(stopped.begin(), stopped.end());
  }
  return best;
}

// d of this length along a unit direction. Where that leaves the bounds, what leaves them ends on
// them, the others use up the length, and the side with the longer way along it is taken.
Vector along_within(const Vector& direction, Real length, const Vector& x, const Bounds* bounds) {
  if (bounds == nullptr || bounds->hold(x + length * direction)) return length * direction;
  Vector best = Vector::Zero(x.size());
  for (const Real sign : {1.0, -1.0}) {
    Vector d = best, held = Vector::Zero(x.size()), free = sign * direction;
    for (bool is_inside = false; !is_inside && free.norm() > 0 && held.norm() < length;) {
      const Vector to =
          x + held + std::sqrt(length * length - held.squaredNorm()) / free.norm() * free;
      const Vector nearest = bounds->nearest(to);
      is_inside = true;
      for (Index i = 0; i < x.size(); ++i) {
        if (to[i] == nearest[i]) continue;
        held[i] = nearest[i] - x[i];
        free[i] = 0;
        is_inside = false;
      }
      d = nearest - x;
    }
    if (std::abs(direction.dot(d)) > (1 + kEqual) * std::abs(direction.dot(best))) best = d;
  }
  return best;
}

struct DfoGn {
  Real radius = 3.6, simplex = 2e-3, noisy_radius = 0.05, least_radius = 1e-14, refinement = 5;

  struct State {
    Matrix X, R;     // (n, n + 1) the points, (m, n + 1) their residuals
    Vector f;        // (n + 1), ½‖r‖², infinite where r is not finite
    Index best = 0;  // of the points
    Real delta = 0, rho = 0, first_rho = 0;
    Real noise = 0;         // of r in a call, relative to ‖r‖; 0: none
    Matrix past_X, past_R;  // (n, most), (m, most), noisy calls
    Index past = 0;         // calls since the start
    // Fits to past calls: how many follow, around which point, within which radius.
    Index fits = 0;
    Vector center;  // (n)
    Real reach = 0;

    Linearization at;
    Vector theta, r;       // (n), (m) of the last call
    Matrix S, inverse, J;  // (n, n) the other points relative to the best, (n, n), (m, n)
    Svd svd;               // of J
  };
  static void persist(State& s, Archive& archive) {
    archive(s.X, s.R, s.f, s.best, s.delta, s.rho, s.first_rho, s.noise, s.past_X, s.past_R, s.past,
            s.fits, s.center, s.reach);
  }
  State init(Meter&, const Vector&) const { return {}; }

  Status step(Meter& f, Vector& theta, State& s) const {
    Status status = Status::running;
    if (s.X.size() == 0)
      begin(f, theta, s);
    else
      status = s.fits > 0 ? refine(f, s) : advance(f, s);
    theta = s.fits > 0 ? s.center : Vector(s.X.col(s.best));
    return status;
  }

  // --- calls

  static Vector inside(const Meter& f, const Vector& theta) {  // rounding may lead outside
    return f.bounds() ? f.bounds()->nearest(theta) : theta;
  }
  static Real evaluate(Meter& f, State& s) {  // ½‖r‖² at s.theta
    f.linearize(s.theta, s.at);
    s.r = (s.at.y() - f.target()).reshaped();
    const Real value = 0.5 * s.r.squaredNorm();
    if (!std::isfinite(value)) return kInfinity;
    if (s.past_X.size() > 0) {
      const Index place = s.past++ % s.past_X.cols();
      s.past_X.col(place) = s.theta;
      s.past_R.col(place) = s.r;
    }
    return value;
  }
  static void put(State& s, Index point, Real value) {  // the last call
    s.X.col(point) = s.theta;
    s.R.col(point) = s.r;
    s.f[point] = value;
    constexpr Real kRounding = 1e-14;  // losses that differ by less are equal
    const Real enough = (1 + kRounding) * s.f.minCoeff();
    for (s.best = 0; s.f[s.best] > enough;) ++s.best;
  }

  void begin(Meter& f, const Vector& theta, State& s) const {
    const Index n = theta.size(), m = f.residuals();
    const Real size = std::max<Real>(1, theta.lpNorm<Eigen::Infinity>());
    s.X.setZero(n, n + 1);
    s.R.setZero(m, n + 1);
    s.f.setConstant(n + 1, kInfinity);
    s.theta = theta;
    f.announce(theta.replicate(1, 2));
    put(s, 0, evaluate(f, s));
    evaluate(f, s);
    const Real level = (s.r - s.R.col(0)).norm() / (std::sqrt(2.0) * s.r.norm());
    constexpr Real kRepeated = 1e-13;  // rounding in another order, as by threads, is not noise
    if (level > kRepeated && std::isfinite(level)) set_noise(s, level);
    // Differences of r over ρ have the relative error noise/ρ, and that of ρ by curvature.
    constexpr Real kBalance = 1.5, kMost = 0.2;
    s.rho = size * simplex;
    if (s.noise > 0)
      s.rho = size * std::clamp(kBalance * std::sqrt(s.noise), std::min(simplex, kMost), kMost);
    s.first_rho = s.rho;
    s.delta = std::max(s.rho, size * (s.noise > 0 ? noisy_radius : radius));
    spread(f, s, theta, s.rho);
  }
  static void set_noise(State& s, Real level) {
    constexpr Index kMostNumbers = Index{1} << 24;
    const Index n = s.X.rows(), m = s.R.rows();
    const Index most = std::clamp<Index>(kMostNumbers / (n + m), 2 * (n + 1), 100 * (n + 1));
    s.noise = level;
    s.past_X.setZero(n, most);
    s.past_R.setZero(m, most);
  }
  // The other points along the axes.
  static void spread(Meter& f, State& s, const Vector& center, Real distance) {
    const Index from = s.best, n = center.size();
    const Bounds* const bounds = f.bounds();
    const auto is_inside = [&](Index j, Real x) {
      return bounds == nullptr || (x >= bounds->lower[j] && x <= bounds->upper[j]);
    };
    Matrix points = center.replicate(1, n);
    for (Index j = 0; j < n; ++j) {
      Real& x = points(j, j);
      x += distance;
      if (is_inside(j, x)) continue;
      x = center[j] - distance;
      if (is_inside(j, x)) continue;
      const Real above = bounds->upper[j] - center[j], below = center[j] - bounds->lower[j];
      x = above >= below ? bounds->upper[j] : bounds->lower[j];
    }
    f.announce(points);
    for (Index point = 0, j = 0; point < s.X.cols(); ++point) {
      if (point == from) continue;
      s.theta = points.col(j);
      Real value = evaluate(f, s);
      if (const Real other = center[j] - distance;  // this side of the axis may have a value
          !std::isfinite(value) && other != s.theta[j] && is_inside(j, other)) {
        s.theta[j] = other;
        value = evaluate(f, s);
      }
      ++j;
      put(s, point, value);
    }
  }

  // --- the model

  // J = (R − r) S⁻¹; false where the points have no model.
  static bool build(State& s) {
    const Index n = s.X.rows();
    s.S.resize(n, n);
    Matrix D(s.R.rows(), n);
    for (Index j = 0; j < n; ++j) {
      s.S.col(j) = s.X.col(point_of(s, j)) - s.X.col(s.best);
      D.col(j) = s.R.col(point_of(s, j)) - s.R.col(s.best);
    }
    const Vector lengths = s.S.colwise().norm();
    if (!(lengths.minCoeff() > 0) || !is_finite(D)) return false;
    const Matrix unit = s.S * lengths.cwiseInverse().asDiagonal();
    if (!thin_svd(unit, s.svd) || !(s.svd.sigma[n - 1] > 0)) return false;
    s.inverse = s.svd.Vt.transpose() * s.svd.sigma.cwiseInverse().asDiagonal();
    s.inverse = (lengths.cwiseInverse().asDiagonal() * s.inverse * s.svd.U.transpose()).eval();
    s.J.noalias() = D * s.inverse;
    return is_finite(s.inverse) && is_finite(s.J) && thin_svd(s.J, s.svd);
  }
  static Index point_of(const State& s, Index column) {
    return column < s.best ? column : column + 1;
  }

  // --- one iteration

  Status advance(Meter& f, State& s) const {
    if (!build(s)) {  // points that coincide, or have no finite residuals
      if (s.delta <= least_radius * s.first_rho) return Status::converged;
      s.delta /= 2;
      s.rho = std::min(s.rho, s.delta);
      spread(f, s, s.X.col(s.best), s.delta);
      return Status::running;
    }
    if (s.noise > 0 && s.f.maxCoeff() - s.f[s.best] <= s.noise * 2 * s.f[s.best])
      return begin_fits(f, s);
    const Vector r = s.R.col(s.best);
    const Vector d = trust_region_step(s.svd, s.J, r, s.delta, s.X.col(s.best), f.bounds());
    const Vector Jd = s.J * d;
    const Real length = d.norm(), predicted = -(r.dot(Jd) + 0.5 * Jd.squaredNorm());
    if (length < s.rho / 2 || !(predicted > 0)) {  // below the resolution of the points
      s.delta = std::max(decrease(s) * s.delta, s.rho);
      return improve_or(f, s, true);
    }
    s.theta = inside(f, s.X.col(s.best) + d);
    const Real value = evaluate(f, s);
    const Real ratio = (s.f[s.best] - value) / predicted;
    set_radius(s, ratio, length);
    if (value < kInfinity) put(s, replaced_by(s, d, ratio > 0), value);
    if (ratio > 0) return Status::running;
    f.reject_step();
    if (!build(s)) return Status::running;
    return improve_or(f, s, std::max(s.delta, length) <= (1 + kEqual) * s.rho);
  }
  static Real decrease(const State& s) {  // of Δ; noise makes some good steps look bad
    constexpr Real kExact = 0.5, kNoisy = 0.95;
    return s.noise > 0 ? kNoisy : kExact;
  }
  static void set_radius(State& s, Real ratio, Real length) {
    constexpr Real kPoor = 0.1, kGood = 0.7, kMost = 1e10;
    if (!(ratio >= kPoor))
      s.delta = std::min(decrease(s) * s.delta, length);
    else if (ratio <= kGood)
      s.delta = std::max(decrease(s) * s.delta, length);
    else
      s.delta = std::min(2 * s.delta, kMost);
    if (s.delta <= 1.5 * s.rho) s.delta = s.rho;
  }
  // The point far from the best one whose Lagrange polynomial is large at the new one: by the
  // square of its distance, as in Powell (2009); with noise, which keeps the points apart, far ones
  // go sooner.
  static Index replaced_by(const State& s, const Vector& d, bool is_better) {
    const Vector lagrange = s.inverse * d;
    const Real power = s.noise > 0 ? 4 : 2;
    const auto score = [&](Real polynomial, Real distance) {
      return std::abs(polynomial) * std::max<Real>(1, std::pow(distance / s.delta, power));
    };
    Index out = s.best;
    Real most = is_better ? score(1 - lagrange.sum(), d.norm()) : 0;
    for (Index j = 0; j < d.size(); ++j) {
      const Real distance = is_better ? (s.S.col(j) - d).norm() : s.S.col(j).norm();
      if (!(score(lagrange[j], distance) > (1 + kEqual) * most)) continue;
      most = score(lagrange[j], distance);
      out = point_of(s, j);
    }
    return out;
  }
  // Where a point is far, it is moved; otherwise ρ is reduced, if it `may` be.
  Status improve_or(Meter& f, State& s, bool may_reduce) const {
    if (s.delta <= 1.5 * s.rho) s.delta = s.rho;
    const Vector distances = s.S.colwise().norm();
    const Index farthest = first_largest(distances);
    const Real distance = distances[farthest];
    if (distance > (1 - kEqual) * std::max(2 * s.delta, 10 * s.rho))
      move(f, s, farthest, std::max(std::min(distance / 10, s.delta / 2), s.rho));
    else if (may_reduce)
      return reduce(f, s);
    return Status::running;
  }
  // To where its Lagrange polynomial is largest within the radius, downhill of both such points.
  static void move(Meter& f, State& s, Index column, Real distance) {
    Vector direction = s.inverse.row(column).normalized();
    const Vector r = s.R.col(s.best);
    constexpr Real kRounding = 1e-12;
    if (r.dot(s.J * direction) > kRounding * s.J.norm() * r.norm()) direction = -direction;
    s.theta =
        inside(f, s.X.col(s.best) + along_within(direction, distance, s.X.col(s.best), f.bounds()));
    put(s, point_of(s, column), evaluate(f, s));
  }
  Status reduce(Meter& f, State& s) const {  // Powell (2009), section 3
    const Real end = least_radius * s.first_rho, before = s.rho, ratio = before / end;
    if (before <= end) return s.noise > 0 ? begin_fits(f, s) : Status::converged;
    const Real slower = s.noise > 0 ? 0.9 : 0.1;
    s.rho = ratio <= 16 ? end : ratio <= 250 ? std::sqrt(ratio) * end : slower * before;
    s.delta = std::max(decrease(s) * before, s.rho);
    return Status::running;
  }

  // --- with noise

  Status begin_fits(Meter& f, State& s) const {
    s.fits = static_cast<Index>(refinement * static_cast<Real>(s.X.cols()));
    s.center = s.X.col(s.best);
    s.reach = std::max(s.S.colwise().norm().maxCoeff(), s.rho);
    return s.fits > 0 ? Status::running : restart(f, s);
  }

  // A call at the minimizer of the fit within reach, or, at every other time, off it along the
  // direction that the fit knows least of.
  Status refine(Meter& f, State& s) const {
    constexpr Real kMisfit = 2, kSmaller = 0.8, kLarger = 1.2;
    Vector r, direction;
    Real excess = 0;
    if (!fit(s, r, direction, excess)) return restart(f, s);
    const Vector d = trust_region_step(s.svd, s.J, r, s.reach, s.center, f.bounds());
    const Real offset = s.reach;
    s.reach *= excess > kMisfit ? kSmaller : kLarger;
    --s.fits;
    s.theta = inside(f, s.center + d);
    if (s.fits % 2 == 0)
      s.center = s.theta;
    else
      s.theta = inside(f, s.theta + (s.fits % 4 == 1 ? -offset : offset) * direction);
    evaluate(f, s);
    if (s.fits > 0) return Status::running;
    s.X.col(s.best) = s.center;
    s.R.col(s.best) = r + s.J * d;
    s.f[s.best] = 0.5 * s.R.col(s.best).squaredNorm();
    return restart(f, s);
  }
  // r + J (x − center) by least squares on the past calls within reach, at least 2 (n + 1); the
  // unit direction (n) in which these calls differ least; and the misfit over the noise.
  static bool fit(State& s, Vector& r, Vector& direction, Real& excess) {
    const Index n = s.X.rows(), m = s.R.rows();
    const Index calls = std::min(s.past, s.past_X.cols());
    const Vector distance = (s.past_X.leftCols(calls).colwise() - s.center).colwise().norm();
    std::vector<Index> order(static_cast<std::size_t>(calls));
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [&](Index i) { return distance[i]; });
    const auto nth = [&](Index i) { return order[static_cast<std::size_t>(i)]; };
    Index used = std::min(calls, 2 * (n + 1));
    while (used < std::min(calls, 20 * (n + 1)) && distance[nth(used)] <= (1 + kEqual) * s.reach)
      ++used;
    const Real scale = std::max(s.reach, distance[nth(used - 1)]);
    Matrix A(used, n + 1), Y(used, m);
    for (Index i = 0; i < used; ++i) {
      A(i, 0) = 1;
      A.row(i).tail(n) = (s.past_X.col(nth(i)) - s.center).transpose() / scale;
      Y.row(i) = s.past_R.col(nth(i)).transpose();
    }
    SymmetricEigen gram;
    if (!symmetric_eigen(A.transpose() * A, gram)) return false;
    constexpr Real kLeast = 1e-10;  // of the largest eigenvalue: rounding of products
    const Vector inverse =
        (gram.lambda.array() > kLeast * gram.lambda[n]).select(gram.lambda.cwiseInverse(), 0);
    const Matrix B = gram.V * inverse.asDiagonal() * (gram.V.transpose() * (A.transpose() * Y));
    r = B.row(0).transpose();
    s.J = B.bottomRows(n).transpose() / scale;
    direction = gram.V.col(0).tail(n).normalized();
    const auto freedom = static_cast<Real>(std::max<Index>(1, used - n - 1));
    excess = (Y - A * B).norm() / std::sqrt(freedom) / (s.noise * r.norm());
    return is_finite(s.J) && is_finite(direction) && thin_svd(s.J, s.svd);
  }

  // The radii of the start, and the nearest points move away.
  Status restart(Meter& f, State& s) const {
    constexpr Index kMoved = 3;  // Cartis et al. (2019), section 4.1
    s.fits = 0;
    s.rho = s.delta = s.first_rho;
    for (Index i = 0; i < std::min(kMoved, s.X.rows()) && build(s); ++i) {
      move(f, s, first_largest(s.S.colwise().norm().cwiseInverse()), s.delta);  // the nearest
    }
    return Status::running;
  }
};

void fields(DfoGn& o, auto& field) {
  field("radius", o.radius, above(0),
        "initial trust-region radius Δ without noise, in units of max(1, ‖θ₀‖∞)");
  field("simplex", o.simplex, above(0),
        "initial distance ρ of the points without noise, in the same units; with relative noise ε "
        "of the residuals, ρ is 1.5 √ε, at most 0.2");
  field("noisy-radius", o.noisy_radius, above(0), "initial Δ with noise, in the same units");
  field("least-radius", o.least_radius, above(0), "final ρ, in units of the initial one");
  field("refinement", o.refinement, between(0, 1000),
        "fits to the past calls before a restart, which only noise causes; in units of n + 1");
}

}  // namespace

void register_dfo_gn(OptimizerRegistry& registry) {
  registry.add(stepper_entry<DfoGn>(
      {.name = "dfo-gn",
       .title = "Derivative-free Gauss-Newton",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "min ‖r + J d‖ over ‖d‖ ≤ Δ,  J by interpolation of r at n+1 points",
       .source = "Cartis, Roberts (2019); Cartis, Fiala, Marteau, Roberts (2019)",
       .note = "Calls the start twice to measure the noise of the calls. A rejected candidate "
               "counts as an iteration.",
       .needs = {Oracle::forward},
       .needs_same_samples = true,
       .keeps_bounds = true,
       .most_unknowns = 256,
       .tunable = {.option = "radius", .below = 4},
       .in_all = false}));  // of the suite forward
}

}  // namespace isoline::optimizers
