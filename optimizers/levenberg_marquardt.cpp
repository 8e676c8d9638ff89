// Levenberg-Marquardt, Marquardt (1963), with Moré's scaling (1978) and the gain-ratio
// rule of Nielsen (1999): d = argmin ‖J d + r‖² + μ‖D d‖², Dⱼ the largest norm the j-th
// column of J has had. Steps that do not lower ‖r‖ are rejected and the damping is raised. After a
// step that gained little, d gets a term of second order. On fresh samples at every step J and r
// are those of the step's own. Where J comes by differences, μ follows from a radius, ‖D d‖ ≤ Δ, as
// Moré has it: there a rejected step is dear, and J is updated by Broyden's formula between; near a
// solution JᵀJ gets the curvature of the residuals, Dennis, Gay, Welsch (1981). With damping=fixed,
// the rule of mini-batches that cannot be compared: θ ← θ − η Jᵀ (K + μ)⁻¹ r, K = JJᵀ, μ a share of
// the mean diagonal of K, and every step is taken; absolute: the same with μ added to JJᵀ/B. With a
// small μ it is the energy natural gradient of Müller, Zeinhofer (2023), in the form of
// Guzmán-Cordero et al. (2025) where J is wide.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/archive.h"
#include "core/array.h"
#include "optimizers/damped_least_squares.h"
#include "optimizers/differences.h"
#include "optimizers/examination.h"
#include "optimizers/nielsen_damping.h"
#include "optimizers/optimizer.h"
#include "optimizers/residual_curvature.h"
#include "optimizers/spectral_step.h"

namespace isoline::optimizers {
namespace {

constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();
constexpr Real kUnbounded = std::numeric_limits<Real>::infinity();
bool has_own_jacobian(const Problem& problem) {
  const OracleSet offers = problem.offers();
  if (problem.products().may_be_replaced && problem.has_identity_network()) return false;
  return offers.contains(Oracle::jacobian) || offers.contains(Oracle::layer_factors) ||
         offers.contains(Oracle::sparse_jacobian) || offers.contains(Oracle::pullback);
}

struct LevenbergMarquardt {
  Real initial_damping = 1e-4, rate = 1, acceleration = 0.75;
  std::string damping = "adaptive", factorization = "auto", scaling = "more", line_search;
  std::string jacobian = "exact", difference_step;
  bool broyden = true;
  Real accuracy = 0;

  struct State {
    DampedLeastSquares squares;
    DifferenceJacobian differences;
    ResidualCurvature curvature;
    SpectralStep spectral;
    NielsenDamping damping;
    bool is_fine = false;     // what steps gain is little beside errors of forward differences
    bool is_retried = false;  // a step was rejected, and J updated by it, since J was fresh
    bool is_limited = false;  // the last step, by the radius
    bool has_point = false;
    Index updates = 0;      // of J since it was fresh
    Real radius = 0;        // Δ, of steps by differences
    Real gain = 1;          // actual over predicted decrease of the last step, 0 where rejected
    Real noise = kEpsilon;  // of y in a call, where the problem's own J is by differences
    Linearization at, trial;
    Vector step, candidate, bend;    // (n), of the acceleration, or with S
    Vector Jd, residual, Jbend;      // (m·B)
    Real last_length = kUnbounded;   // ‖D d‖ of the last step that only rounding could judge
    Real last_promise = kUnbounded;  // of ½‖r‖², that the last step by a fresh J was to gain
    Index longer = 0;                // steps that only rounding could judge, and were not shorter
    std::string jacobian;            // as the option has it; by differences where none is offered

    bool has_updated_jacobian() const { return jacobian != "exact" && !differences.is_fresh(); }
  };
  static void persist(State& s, Archive& archive) {
    s.squares.persist(archive);
    s.spectral.persist(archive);
    s.damping.persist(archive);
    s.differences.persist(archive);
    s.curvature.persist(archive);
    archive(s.is_fine, s.has_point, s.is_retried, s.is_limited, s.updates, s.radius, s.gain,
            s.noise, s.last_length, s.last_promise, s.longer, s.residual);
  }

  State init(Meter& f, const Vector&) const {
    State s;
    s.jacobian = jacobian == "exact" && !has_own_jacobian(f.problem()) ? "differences" : jacobian;
    s.differences.take_steps(difference_step, f);
    if (accuracy > 0) f.take_as_enough(accuracy);
    s.squares.start(f);
    s.damping.mu = initial_damping;
    s.spectral = SpectralStep(spectral_factorization(factorization));
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    return damping == "adaptive" ? step_adaptive(f, theta, s) : step_fixed(f, theta, s);
  }

  Status step_adaptive(Meter& f, Vector& theta, State& s) const {
    if (!s.has_point || f.has_fresh_batches()) {
      f.linearize(theta, s.at);
      accept(f, theta, s);
    }
    if (s.jacobian != "exact" && !f.has_fresh_batches()) return step_within(f, theta, s);
    if (accuracy > 0 && s.squares.solve(kUndamped, factorization, s.step, s.Jd) &&
        leaves_enough(s, theta))
      return Status::converged;
    if (!s.squares.solve(s.damping.mu, factorization, s.step, s.Jd)) return Status::stalled;
    Real predicted = predicted_decrease(s);
    const bool accelerates = acceleration > 0 && s.gain < kPoorGain;
    if (accelerates && !accelerate(f, theta, s)) return reject(f, theta, s);
    s.candidate = theta + s.step;
    if (f.bounds() && !f.bounds()->hold(s.candidate)) {
      keep_within(f, theta, s);
      s.candidate = f.bounds()->nearest(theta + s.step);
      s.squares.push_dense(s.step, s.Jd);
      predicted = s.residual.dot(s.Jd) - 0.5 * s.Jd.squaredNorm();
    }
    if (s.candidate == theta && !f.has_fresh_batches()) return stop(f, theta, s);
    f.linearize(s.candidate, s.trial);
    const Real actual = s.squares.misfit() - 0.5 * (s.trial.y() - f.target()).squaredNorm();
    const Real rounding = f.has_fresh_batches() ? 0 : rounding_of_misfit(f, s);
    const bool is_rounding = predicted <= rounding && std::abs(actual) <= rounding;
    if (is_rounding) {
      const Real length = std::sqrt(s.squares.squared_length(s.step));
      if (!(length <= s.last_length / 2)) return stop(f, theta, s);
      s.last_length = length;
    } else if (!(actual > 0 && predicted > 0)) {
      return reject(f, theta, s);
    }
    theta = s.candidate;
    std::swap(s.at, s.trial);
    s.gain = is_rounding ? 1 : actual / predicted;
    if (!f.has_fresh_batches()) accept(f, theta, s);
    s.damping.accept(s.gain);
    return Status::running;
  }

  Status reject(Meter& f, const Vector&, State& s) const {
    f.reject_step();
    s.gain = 0;
    return s.damping.reject();
  }
  // A J of updates does not tell that no step is left, nor forward differences the sixth digit of
  // what they hardly determine.
  Status stop(Meter& f, const Vector& theta, State& s) const {
    if (s.has_updated_jacobian()) return renew(f, theta, s);
    const bool can_refine = s.jacobian != "exact" && s.jacobian != "central" && !s.is_fine;
    return can_refine && is_blurred(f, theta, s) ? refine(f, theta, s) : Status::converged;
  }
  // From here on J is by central differences.
  Status refine(Meter& f, const Vector& theta, State& s) const {
    s.is_fine = true;
    s.last_length = s.last_promise = kUnbounded;
    return renew(f, theta, s);
  }
  bool is_blurred(const Meter& f, const Vector& theta, State& s) const {
    const Problem& problem = f.problem();
    const Matrix& J = s.at.jacobian();
    const Vector slope = -J.transpose() * s.residual;
    LeastSquaresPoint at{.J = J,
                         .residual = -s.residual,
                         .theta = theta,
                         .sizes = sizes_of_unknowns(problem.standard_start()),
                         .is_held = std::vector<bool>(static_cast<std::size_t>(theta.size())),
                         .names = problem.names(),
                         .size_of_y = s.at.y().norm(),
                         .noise = s.differences.noise(),
                         .has_exact_jacobian = false,
                         .is_central = s.differences.is_central(),
                         .enough_of_deviation = std::max(accuracy, kEnoughOfDeviation),
                         .forgives_noise = false,
                         .sure = 1};
    for (Index i = 0; f.bounds() && i < theta.size(); ++i)
      at.is_held[static_cast<std::size_t>(i)] =
          f.bounds()->is_active(theta, slope, i) || f.bounds()->lower[i] == f.bounds()->upper[i];
    return !doubt_of(at).empty();
  }
  Status renew(Meter& f, const Vector& theta, State& s) const {
    s.differences.renew(f, theta, s.is_fine ? "central" : s.jacobian, s.at);
    s.squares.set(f, s.at, theta, s.residual, scaling);
    if (!s.differences.is_noisy()) s.curvature.measured(s.at.jacobian(), theta, s.residual);
    s.updates = 0;
    s.is_retried = false;
    return Status::running;
  }

  // A step within the radius, by a J of differences.
  Status step_within(Meter& f, Vector& theta, State& s) const {
    constexpr Real kSettled = 1e-7;  // of ½‖r‖², that the Gauss-Newton step would gain
    constexpr Real kFirst = 0.25, kLonger = 1.1, kShorter = 0.9;
    constexpr Index kMostLonger = 3;  // by errors of J, such as those of a call that failed
    Vector sizes(theta.size()), least(theta.size());
    for (Index j = 0; j < theta.size(); ++j) {
      sizes[j] = s.differences.size_of(theta, j);
      least[j] = least_size(theta[j], sizes[j]);
    }
    if (!s.squares.solve(kUndamped, factorization, s.step, s.Jd)) return stalled(f, theta, s);
    const bool is_fresh = !s.has_updated_jacobian();
    const Real share = s.step.cwiseQuotient(least).lpNorm<Eigen::Infinity>();
    const bool is_settled = 0.5 * s.Jd.squaredNorm() <= kSettled * s.squares.misfit();
    const bool is_enough = share <= kEnoughOfUnknown || leaves_enough(s, theta);
    if (is_enough || (is_settled && !is_fresh)) return stop(f, theta, s);
    if (is_fresh && s.is_fine && s.differences.is_noisy() && !is_blurred(f, theta, s))
      return Status::converged;
    if (is_fresh && stagnates(s))
      return s.is_fine || s.jacobian == "central" ? Status::converged : refine(f, theta, s);
    if (s.radius == 0) s.radius = kFirst * std::sqrt(s.squares.squared_length(sizes));
    const bool bends = bend(s) && length_of(s.squares, s.bend) <= kLonger * s.radius;
    if (bends) s.step = s.bend;
    s.is_limited = length_of(s.squares, s.step) > kLonger * s.radius;
    if (s.is_limited && !shorten(s)) return stalled(f, theta, s);
    s.candidate = theta + s.step;
    if (f.bounds()) s.candidate = f.bounds()->nearest(s.candidate);
    if (s.candidate == theta) return stop(f, theta, s);
    s.step = s.candidate - theta;
    s.squares.push_dense(s.step, s.Jd);
    const Real slope = s.residual.dot(s.Jd), misfit = s.squares.misfit();
    const Real curvature = s.Jd.squaredNorm() + (bends ? s.curvature.along(s.step) : 0);
    const Real predicted = slope - 0.5 * curvature, rounding = rounding_of_misfit(f, s);
    if (!is_fresh && std::abs(predicted) <= rounding) return renew(f, theta, s);
    f.linearize(s.candidate, s.trial);
    const Real actual = misfit - 0.5 * (s.trial.y() - f.target()).squaredNorm();
    const Real length = length_of(s.squares, s.step);
    const bool is_rounding =
        std::abs(predicted) <= rounding && std::abs(actual) <= rounding;  // false for NaN
    if (is_rounding) {
      const bool may_be_by_chance = is_fresh && s.is_fine && s.differences.is_noisy();
      if (!(length <= kShorter * s.last_length) && (!may_be_by_chance || s.longer++ >= kMostLonger))
        return stop(f, theta, s);
      s.last_length = length;
    }
    // On a bound, J may predict no decrease of a step that has one.
    const bool is_better = predicted <= 0 && actual > rounding;
    s.gain = is_rounding || is_better                 ? 1
             : std::isfinite(actual) && predicted > 0 ? actual / predicted
                                                      : -1;
    if (s.gain < kPoorGain && is_fresh) {
      s.radius = shrinkage(actual, slope) * std::min(s.radius, length);
    } else if (s.gain > 1 - kPoorGain || !s.is_limited) {
      s.radius = std::max(s.radius, 2 * length);
    }
    constexpr Real kAccepted = 1e-4;
    if (s.gain > kAccepted) {
      theta = s.candidate;
      std::swap(s.at, s.trial);
      accept(f, theta, s);
      return Status::running;
    }
    f.reject_step();
    if (is_fresh) return s.radius > 0 ? Status::running : Status::converged;
    constexpr Real kFar = 99,
                   kNear = 0.1;  // of ½‖r‖²: where a point tells little of J, or J is dear
    if (s.is_retried || predicted <= kNear * misfit || !(-actual <= kFar * misfit))
      return renew(f, theta, s);
    constexpr Real kNearer = 0.6;
    s.is_retried = true;
    s.radius = kNearer * std::min(s.radius, length);
    s.differences.learn(s.candidate, s.trial.y().reshaped(), s.squares.scale(), s.at);
    s.squares.set(f, s.at, theta, s.residual, scaling);
    return Status::running;
  }
  // Whether what a full step by a fresh J gains is tiny, and no longer shrinks: errors of J make
  // it.
  static bool stagnates(State& s) {
    constexpr Real kTiny = 1e-10, kShrinks = 0.5;
    const Real gains = 0.5 * s.Jd.squaredNorm(), before = std::exchange(s.last_promise, gains);
    return !s.is_limited && gains <= kTiny * s.squares.misfit() && gains > kShrinks * before;
  }
  // The step with the curvature of the residuals, near a solution.
  static bool bend(State& s) {
    constexpr Real kNear = 1e-2;  // of ½‖r‖², that the Gauss-Newton step would gain
    return 0.5 * s.Jd.squaredNorm() <= kNear * s.squares.misfit() &&
           s.curvature.solve(s.squares.jacobian(), s.residual, s.squares.scale(), s.bend);
  }
  // ‖J d‖ in units of ‖r‖/√(m − n) is at least |dⱼ| in standard deviations of unknown j.
  bool leaves_enough(const State& s, const Vector& theta) const {
    const Real share = std::max(kEnoughOfDeviation, accuracy);
    const auto freedom = static_cast<Real>(s.residual.size() - theta.size());
    return freedom > 0 && freedom * s.Jd.squaredNorm() <= share * share * s.residual.squaredNorm();
  }
  Status stalled(Meter& f, const Vector& theta, State& s) const {
    return s.has_updated_jacobian() ? renew(f, theta, s) : Status::stalled;
  }
  static Real length_of(const DampedLeastSquares& squares, const Vector& d) {
    return std::sqrt(squares.squared_length(d));
  }
  // The μ at which ‖D d‖ is the radius to a tenth, by the secant of 1/‖D d‖, which is nearly linear
  // in μ; within a bracket. False where no step is finite.
  bool shorten(State& s) const {
    constexpr int kMostTries = 60;
    constexpr Real kToTheRadius = 0.1;
    Real low = 0, high = kUnbounded, mu = 0.5 * s.Jd.squaredNorm() / (s.radius * s.radius);
    Real last_mu = 0, last = 1 / length_of(s.squares, s.step);  // as good as undamped
    for (int i = 0; i < kMostTries; ++i) {
      if (!s.squares.solve(mu, factorization, s.step, s.Jd)) return false;
      const Real length = length_of(s.squares, s.step);
      if (std::abs(length - s.radius) <= kToTheRadius * s.radius) return true;
      (length > s.radius ? low : high) = mu;
      const Real change = (1 / length - last) / (mu - last_mu);
      Real next = mu + (1 / s.radius - 1 / length) / change;
      last_mu = mu;
      last = 1 / length;
      if (!(next > low && next < high))
        next = high == kUnbounded ? 10 * mu : low == 0 ? high / 10 : std::sqrt(low * high);
      mu = next;
    }
    return true;
  }
  // The share of the radius after a poor step: where the parabola through ½‖r‖² at both ends, with
  // the slope at the first one, is least.
  static Real shrinkage(Real actual, Real slope) {
    constexpr Real kLeast = 0.1, kMost = 0.5, kBlind = 0.25;
    if (!std::isfinite(actual)) return kBlind;
    return actual >= 0 ? kMost : std::clamp(0.5 * slope / (slope - actual), kLeast, kMost);
  }

  // Up to a gain of 1/4, Moré (1978) reduces the radius: r is far from linear in d. A J is updated
  // after a gain of 1/10 by a fresh one, and of 0.3 to 1.7 by an updated one.
  static constexpr Real kUndamped = 1e-30;  // μ
  static constexpr Real kPoorGain = 0.25, kLeastGain = 0.1, kOff = 0.7;
  static constexpr Index kMostUpdates = 2;  // for each unknown

  Status step_fixed(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    if (s.jacobian != "exact") s.differences.renew(f, theta, s.jacobian, s.at);
    s.residual = (s.at.y() - f.target()).reshaped();
    const auto filter = damping == "absolute" ? absolute_filter(initial_damping, f.samples())
                                              : tikhonov_filter(initial_damping);
    if (line_search.empty())
      return s.spectral.add(f, s.at, filter, s.residual, -rate, theta) ? Status::running
                                                                       : Status::stalled;
    s.step.setZero(theta.size());
    if (!s.spectral.add(f, s.at, filter, s.residual, -1, s.step)) return Status::stalled;
    const Real length = length_on_grid(f, theta, s.step, rate, s.candidate);
    if (length == 0) return Status::stalled;
    theta += length * s.step;
    return Status::running;
  }

  // J, −r and D at the point just accepted.
  void accept(Meter& f, const Vector& theta, State& s) const {
    s.residual = (f.target() - s.at.y()).reshaped();
    const bool is_first = !std::exchange(s.has_point, true) || f.has_fresh_batches();
    if (s.jacobian != "exact") {
      const bool is_fresh = s.differences.is_fresh();
      const bool is_good = s.updates < kMostUpdates * theta.size() && s.gain >= kLeastGain &&
                           (is_fresh || std::abs(s.gain - 1) <= kOff);
      if (is_first || !broyden || !is_good) {
        renew(f, theta, s);
        return;
      }
      s.differences.update(theta, s.squares.scale(), s.at);
      ++s.updates;
    }
    s.squares.set(f, s.at, theta, s.residual, scaling);
    s.noise = std::max(s.noise, f.problem().products().noise);
  }

  // A step that leaves the bounds takes the unknowns that leave onto them, and the others from
  // there by J: moved onto the bounds as it is, it need not lower the loss.
  void keep_within(Meter& f, const Vector& theta, State& s) const {
    const Bounds& bounds = *f.bounds();
    DampedLeastSquares rest = s.squares;
    Vector to = theta, moved, step;
    std::vector<bool> is_held(static_cast<std::size_t>(theta.size()));
    constexpr int kMostPasses = 8;
    for (int pass = 0; pass < kMostPasses && !bounds.hold(theta + s.step); ++pass) {
      const Vector beyond = theta + s.step, nearest = bounds.nearest(beyond);
      for (Index i = 0; i < to.size(); ++i) {
        if (beyond[i] == nearest[i]) continue;
        to[i] = nearest[i];
        is_held[static_cast<std::size_t>(i)] = true;
      }
      moved = to - theta;
      s.squares.push_dense(moved, s.Jd);
      rest.set(f, s.at, to, s.residual - s.Jd, scaling);
      for (Index i = 0; i < to.size(); ++i)
        if (is_held[static_cast<std::size_t>(i)]) rest.hold(i);
      if (!rest.solve(s.damping.mu, factorization, step, s.Jd)) break;
      s.step = moved + step;
    }
    s.step = bounds.nearest(theta + s.step) - theta;  // what is left, or rounding
  }

  // The decrease of ½‖r‖², ½‖J d‖² + μ‖D d‖², without cancellation.
  static Real predicted_decrease(const State& s) {
    return 0.5 * s.Jd.squaredNorm() + s.damping.mu * s.squares.squared_length(s.step);
  }

  // Where a step and its prediction change ½‖r‖² by less, the loss cannot judge it; x, which
  // depends on the gradient, still becomes more accurate as long as steps become shorter.
  static Real rounding_of_misfit(Meter& f, const State& s) {
    const Real largest = (f.target().reshaped() - s.residual).lpNorm<Eigen::Infinity>();  // of y
    const Real noise = s.jacobian == "exact" ? s.noise : s.differences.noise();
    return optimizers::rounding_of_misfit(s.squares.misfit(), s.residual.norm(), largest, noise);
  }

  // Geodesic acceleration, Transtrum and Sethna (2012): d ← d + a, a = argmin ‖J a + ½ r''‖² +
  // μ‖D a‖² with r'' the second derivative of r along d, by one more evaluation. False where
  // 2‖D a‖ > α‖D d‖: the model does not hold as far as d.
  bool accelerate(Meter& f, const Vector& theta, State& s) const {
    constexpr Real kShare = 0.1, kAccurate = 1e-2;  // of d, and of J d
    s.Jbend = f.target().reshaped() - s.residual;   // y
    const Real error = kEpsilon * s.Jbend.norm() / (kShare * kShare);
    if (s.noise > kEpsilon || error > kAccurate * s.Jd.norm()) return true;
    s.candidate = theta + kShare * s.step;
    if (f.bounds() && !f.bounds()->hold(s.candidate)) return true;  // d is projected as it is
    f.linearize(s.candidate, s.trial);
    s.Jbend = (s.Jd - (s.trial.y().reshaped() - s.Jbend) / kShare) / kShare;
    if (!is_finite(s.Jbend)) return false;
    s.squares.set_right(s.Jbend);
    const bool is_solved = s.squares.solve(s.damping.mu, factorization, s.bend, s.Jbend);
    s.squares.set_right(s.residual);
    const Real bound = acceleration * acceleration * s.squares.squared_length(s.step);
    if (!is_solved || !(4 * s.squares.squared_length(s.bend) <= bound)) return false;
    s.step += s.bend;
    return true;
  }

  static Factorization spectral_factorization(const std::string& factorization) {
    if (factorization == "sparse") return Factorization::automatic;
    return factorization == "orthogonal" ? Factorization::qr : factorization_named(factorization);
  }
};

void fields(LevenbergMarquardt& o, auto& field) {
  field("initial-damping", o.initial_damping, above(0),
        "damping μ at the start, in units of D²; for damping=fixed, μ as a share of the mean "
        "diagonal of JJᵀ; for damping=absolute, μ itself, added to JJᵀ/B");
  field("acceleration", o.acceleration, at_least(0),
        "for damping=adaptive: α of geodesic acceleration. After a step with a gain below 1/4, "
        "the second-order correction a is added to d; if 2‖D a‖ > α‖D d‖, the step is rejected. "
        "0: no acceleration");
  field("damping", o.damping, Choices{"adaptive", "fixed", "absolute"},
        "by the gain of each step, or always the same, in either unit");
  field("rate", o.rate, above(0), "of a damping that is not adaptive: step length η");
  field("line-search", o.line_search, Choices{"", "grid"},
        "of a damping that is not adaptive; grid: of η, η/2, …, η/2³⁰, the step length with the "
        "lowest loss on the samples of the step");
  field("factorization", o.factorization, Choices{"auto", "orthogonal", "cholesky", "sparse"},
        "by QR; by Cholesky of the smaller Gram matrix, which of networks of dense layers is "
        "formed layer by layer; or by sparse Cholesky of a sparse J, after elimination of blocks "
        "where the problem declares them, of damping=adaptive; auto: by size and accuracy");
  field("scaling", o.scaling, Choices{"more", "fading", "none", "jacobian"},
        "for damping=adaptive, the diagonal of D: more: the largest norm that each column of J "
        "has had; fading: the same, but halved at each step; none: 1; jacobian: the current norms");
  field("jacobian", o.jacobian, kJacobians, kJacobianHelp);
  field("difference-step", o.difference_step, {}, kStepHelp);
  field(
      "accuracy", o.accuracy, between(0, 1),
      "for damping=adaptive: a run ends where the next step is predicted to change no unknown by more "
      "than this share of its standard deviation; 0: at 1e-6 of the unknown");
  field("broyden", o.broyden,
        "of a J by differences and damping=adaptive: after steps with a gain above 1/4 J is "
        "updated by Broyden's formula");
}

std::string objection_of_levenberg_marquardt(const OptionValues& options, const Problem& problem) {
  if (!problem.bounds()) return "";
  const bool has_projection =
      options.text("damping") == "adaptive" && options.text("factorization") != "sparse";
  if (has_projection || !problem.bounds()->are_needed) return "";
  return "the problem has bounds on x, which only damping=adaptive without factorization=sparse "
         "respects";
}

OracleSet needs_of_levenberg_marquardt(const OptionValues& options, const Problem& problem) {
  const std::string factorization = options.text("factorization");
  if (options.text("jacobian") != "exact" || !has_own_jacobian(problem)) return {Oracle::forward};
  if (problem.bounds() && options.text("damping") == "adaptive")
    return {Oracle::forward, Oracle::jacobian};
  if (options.text("damping") != "adaptive")
    return needs_of(LevenbergMarquardt::spectral_factorization(factorization), tikhonov_filter(1),
                    problem);
  if (factorization == "sparse" || (factorization == "auto" && is_solved_sparse(problem)))
    return {Oracle::forward, Oracle::sparse_jacobian};
  const bool is_wide = problem.residuals() < problem.unknowns();
  const bool squares = factorization == "cholesky" ||
                       (factorization == "auto" && problem.residuals() >= kLeastSquared);
  const bool by_layers = is_wide && squares && problem.offers().contains(Oracle::layer_factors);
  return {Oracle::forward, by_layers ? Oracle::layer_factors : Oracle::jacobian};
}

}  // namespace

void register_levenberg_marquardt(OptimizerRegistry& registry) {
  registry.add(stepper_entry<LevenbergMarquardt>(
      {.name = "levenberg-marquardt",
       .title = "Levenberg-Marquardt",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "θ ← θ + argmin ‖J d + r‖² + μ‖D d‖²",
       .source = "Marquardt (1963); Moré (1978); Nielsen (1999); Transtrum, Sethna (2012); by "
                 "differences Broyden (1965); Gay, Schnabel (1978); Dennis, Gay, Welsch (1981)",
       .note =
           "A rejected candidate counts as an iteration. With damping=fixed, every step is "
           "accepted, D is 1, and μ is a share of the mean diagonal of JJᵀ. On mini-batches, the "
           "largest norm of a column may come from an earlier batch: on coupled-oscillators with "
           "tanh neurons, D = 1 (scaling=none) converges from starts from which Moré's scaling "
           "diverges. On a problem with bounds, unknowns at a bound that ∇L presses against are "
           "left out of a step, and the candidate is projected onto the bounds; Bertsekas (1982), "
           "Kanzow, Yamashita, Fukushima (2004).",
       .needs = {Oracle::forward},
       .is_input_scale_invariant = true,
       .keeps_bounds = true,
       .most_rank = 4000,
       .tunable = {.option = "initial-damping", .factor = 10},
       .needs_for = needs_of_levenberg_marquardt,
       .objection = objection_of_levenberg_marquardt}));
}

}  // namespace isoline::optimizers
