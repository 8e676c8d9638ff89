// Any direct problem with noise, another model, scaled and rotated unknowns, few digits, a penalty,
// or evaluations that fail.
#include "problems/features.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "core/decompose.h"
#include "core/differences.h"
#include "core/errors.h"
#include "core/failures.h"
#include "problems/differences.h"
#include "problems/wrapper.h"

namespace isoline::problems {
namespace {

// x = S Q z.
struct Map {
  Vector scales;              // of S, (k); empty: all 1
  Matrix rotation;            // Q, (k, k); empty: identity
  std::optional<Bounds> box;  // that rounding must not leave

  bool is_identity() const { return scales.size() == 0 && rotation.size() == 0; }
  Matrix to_x(BatchRef z) const {
    Matrix x = rotation.size() > 0 ? Matrix(rotation * z) : Matrix(z);
    if (scales.size() > 0) x.array().colwise() *= scales.array();
    return x;
  }
  Matrix point(BatchRef z) const { return box ? Matrix(box->nearest(to_x(z))) : to_x(z); }
  Matrix transposed(BatchRef x) const {
    Matrix z = x;
    if (scales.size() > 0) z.array().colwise() *= scales.array();
    return rotation.size() > 0 ? Matrix(rotation.transpose() * z) : z;
  }
  Matrix to_z(BatchRef x) const {
    Matrix z = x;
    if (scales.size() > 0) z.array().colwise() /= scales.array();
    return rotation.size() > 0 ? Matrix(rotation.transpose() * z) : z;
  }
};

Map map_of(const Features& features, Index k, const Draw& draw) {
  Map map;
  if (features.scale != 1) {
    map.scales.resize(k);
    for (Index i = 0; i < k; ++i) {
      const Real share = k > 1 ? static_cast<Real>(i) / static_cast<Real>(k - 1) : 1;
      map.scales[i] = std::pow(features.scale, share - 0.5);
    }
  }
  if (features.rotate) {
    constexpr Index kMost = 2048;
    require(k <= kMost, [&] {
      return fmt::format("rotate=true requires at most {} unknowns, got {}", kMost, k);
    });
    RandomStream stream = draw.stream("rotate");
    const Matrix normal = stream.normal_vector(k * k).reshaped(k, k);
    SymmetricEigen random;  // its eigenvectors have no preferred direction
    require(symmetric_eigen(normal + normal.transpose(), random), "no rotation was found");
    map.rotation = std::move(random.V);
  }
  return map;
}

// To so many significant digits, toward 0.
void round_values(BatchOut y, Index digits) {
  for (Real& value : y.reshaped()) {
    if (value == 0 || !std::isfinite(value)) continue;
    const Real places = static_cast<Real>(digits - 1) - std::floor(std::log10(std::abs(value)));
    const Real unit = std::pow(10.0, places);
    value = std::trunc(value * unit) / unit;
  }
}

constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN();

// The workspace of the physics inside, at x.
struct Inside final : Scratch, Pieces {
  Workspace w;
  bool has_failed = false;  // the last forward pass
  void add_choices(PieceDigest& digest) override {
    if (auto* pieces = dynamic_cast<Pieces*>(w.own.get())) pieces->add_choices(digest);
  }
};

// Where the evaluation fails: in layers, where sin(wᵀ(x − c) + φ) exceeds cos(π share), with w in a
// random direction. c is x*, or x₀ where no x* is known; a layer and its distance to the next one
// are as thick together as c is large. They do not depend on the method.
struct FailingLayers {
  Vector w;       // (k); empty: none
  Vector centre;  // c, (k)
  Real phase = 0, least = 1;

  bool hold(VectorRef x) const {
    return w.size() > 0 && std::sin(w.dot(x - centre) + phase) > least;
  }
};

// `free` are points that no layer may hold.
FailingLayers layers_of(Real share, const Vector& centre, const std::vector<Vector>& free,
                        RandomStream stream) {
  if (share == 0) return {};
  constexpr int kMostDraws = 10'000;
  const Real common = centre.norm() / std::sqrt(static_cast<Real>(centre.size()));
  FailingLayers layers{.w = stream.normal_vector(centre.size()).normalized(),
                       .centre = centre,
                       .least = std::cos(std::numbers::pi * share)};
  for (Index i = 0; i < centre.size(); ++i) {
    const Real size = std::max(std::abs(centre[i]), common);
    layers.w[i] *= 2 * std::numbers::pi / (size > 0 ? size : 1);
  }
  for (int draw = 0; draw < kMostDraws; ++draw) {
    layers.phase = 2 * std::numbers::pi * stream.uniform();
    if (std::ranges::none_of(free, [&](const Vector& x) { return layers.hold(x); })) return layers;
  }
  throw UsageError(
      fmt::format("fail={} leaves no region without failures around x₀ and x*", share));
}

class Featured final : public Wrapper {
 public:
  Featured(std::unique_ptr<Physics> inside, Map map, FailingLayers layers, const Features& features)
      : inside_(std::move(inside)),
        map_(std::move(map)),
        layers_(std::move(layers)),
        digits_(features.digits),
        order_(features.order),
        weight_(std::sqrt(features.tikhonov)) {}

  Index inputs() const override { return inside_->inputs(); }
  Index outputs() const override { return m() + penalties(); }
  Index penalties() const { return weight_ > 0 ? inputs() - order_ : 0; }
  const Map& map() const { return map_; }
  const Physics& inside() const override { return *inside_; }
  Vector inner_point(VectorRef z) const override { return map_.point(z); }
  Matrix inner_slopes(VectorRef z) const override {
    return map_.to_x(Matrix::Identity(z.size(), z.size()));
  }

  void begin_forwards(BatchRef z) const override {
    Matrix x(z.rows(), z.cols());
    for (Index b = 0; b < z.cols(); ++b) x.col(b) = map_.point(z.col(b));  // to the last bit
    inside_->begin_forwards(x);
  }
  void forward(BatchRef z, BatchRef c, BatchOut y, Workspace& w) const override {
    Workspace& in = w.as<Inside>().w;
    in.x = map_.point(z);
    in.context = c;
    in.saved_is_current = false;
    inside_->forward(in.x, c, y.topRows(m()), in);
    w.as<Inside>().has_failed = layers_.hold(in.x.col(0));
    if (has_failed(w)) {
      add_failure({z.data(), static_cast<std::size_t>(z.rows())}, "x lies in a layer of fail=");
      y.setConstant(kNaN);
      return;
    }
    if (digits_ > 0) round_values(y.topRows(m()), digits_);
    penalize(in.x, y);
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    if (has_failed(w)) {
      Jv.setConstant(kNaN);
      return;
    }
    const Matrix dx = map_.to_x(v);
    inside_->pushforward(dx, Jv.topRows(m()), w.as<Inside>().w);
    penalize(dx, Jv);
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    if (has_failed(w)) {
      JTu.setConstant(kNaN);
      return;
    }
    Matrix dx(inputs(), u.cols());
    inside_->pullback(u.topRows(m()), dx, w.as<Inside>().w);
    const auto rows = u.bottomRows(penalties());
    if (penalties() > 0) {
      dx.bottomRows(penalties()) += weight_ * rows;
      if (order_ == 1) dx.topRows(penalties()) -= weight_ * rows;
    }
    JTu = map_.transposed(dx);
  }
  void jacobian(BatchOut J, Workspace& w) const override {
    if (has_failed(w)) {
      J.setConstant(kNaN);
      return;
    }
    const Index k = inputs();
    inside_->jacobian(J.topRows(m()), w.as<Inside>().w);
    for (Index b = 0; b < J.cols() / k; ++b) {
      auto block = J.middleCols(b * k, k);
      penalize(Matrix::Identity(k, k), block);
      if (!map_.is_identity()) block = map_.transposed(block.transpose()).transpose().eval();
    }
  }
  Products products() const override { return inside_->products(); }
  bool is_elsewhere() const override { return inside_->is_elsewhere(); }

  bool has_curvature() const override { return inside_->has_curvature(); }
  void curvature(BatchRef u, BatchOut out, Workspace& w) const override {
    const Index k = inputs();
    inside_->curvature(u.topRows(m()), out, w.as<Inside>().w);
    if (map_.is_identity()) return;
    for (Index b = 0; b < u.cols(); ++b) {
      auto block = out.middleCols(b * k, k);
      block = map_.transposed(map_.transposed(block).transpose()).eval();
    }
  }
  void curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const override {
    inside_->curvature_product(u.topRows(m()), map_.to_x(v), out, w.as<Inside>().w);
    if (!map_.is_identity()) out = map_.transposed(out);
  }

  Inverse inverse_kind() const override {
    if (weight_ > 0) return Inverse::none;
    const Inverse kind = inside_->inverse_kind();
    return (digits_ > 0 || layers_.w.size() > 0) && kind == Inverse::exact ? Inverse::approximate
                                                                           : kind;
  }
  Index inverse_price() const override { return inside_->inverse_price(); }
  Success local_inverse(BatchRef y, BatchRef z0, BatchRef c, BatchOut z) const override {
    Success success = inside_->local_inverse(y, map_.to_x(z0), c, z);
    for (Index b = 0; b < z.cols(); ++b) success(b) = success(b) && !layers_.hold(z.col(b));
    z = map_.to_z(z);
    return success;
  }

 private:
  Index m() const { return inside_->outputs(); }
  static bool has_failed(Workspace& w) { return w.as<Inside>().has_failed; }
  // The rows √α D x below those of P.
  void penalize(BatchRef x, BatchOut y) const {
    if (penalties() == 0) return;
    auto rows = y.bottomRows(penalties());
    rows = weight_ * x.bottomRows(penalties());
    if (order_ == 1) rows -= weight_ * x.topRows(penalties());
  }

  std::unique_ptr<Physics> inside_;
  Map map_;
  FailingLayers layers_;
  Index digits_, order_;
  Real weight_;  // √α
};

// The parts of the problem in z, with the penalty. Pictures and series of x do not fit it.
void wrap(ProblemParts& parts, Map map, FailingLayers layers, const Features& features) {
  auto physics = std::make_unique<Featured>(std::move(parts.physics), std::move(map),
                                            std::move(layers), features);
  const Map& to = physics->map();
  parts.start = {to.to_z(parts.start.drawn).reshaped(), to.to_z(parts.start.standard).reshaped()};
  for (auto* each : {&parts.truth, &parts.made_from})
    if (*each) *each = to.to_z(**each);
  if (parts.bounds)
    for (Vector* each : {&parts.bounds->lower, &parts.bounds->upper}) *each = to.to_z(*each);
  if (!to.is_identity() && parts.x_error)
    parts.x_error = [inner = parts.x_error, to](BatchRef z, const Batch& batch) {
      Batch in_x = batch;
      if (in_x.truth.size() > 0) in_x.truth = to.to_x(batch.truth);
      return inner(to.to_x(z), in_x);
    };
  if (!to.is_identity()) parts.names = parts.units = {};
  const Index rows = physics->penalties();
  add_penalties(parts, rows);  // beside those of priors
  if (!to.is_identity() || rows > 0) leave_views_out(parts);
  parts.physics = std::move(physics);
}

constexpr Real kOutliers = 0.1, kOutlier = 10;  // share of the values, and factor of the noise

// (m)
Vector noise_of(const Features& features, const Vector& target, RandomStream stream) {
  const auto m = static_cast<Real>(target.size());
  const Real rms = target.norm() / std::sqrt(m), sigma = features.noise * rms;
  require(rms > 0, "noise is relative to the root mean square of y*, which is 0 for this problem");
  if (features.noise_kind == "uniform") {
    const Real half = sigma * std::sqrt(3.0);
    return stream.uniform_vector(target.size(), -half, half);
  }
  Vector noise = sigma * stream.normal_vector(target.size());
  if (features.noise_kind == "outliers") {
    for (Real& value : noise)
      if (stream.uniform() < kOutliers) value *= kOutlier;
  }
  return noise;
}

// The square root of the mean square of the noise, relative to that of gaussian noise.
Real size_of_noise(const std::string& kind) {
  return kind == "outliers" ? std::sqrt(1 - kOutliers + kOutliers * kOutlier * kOutlier) : 1;
}

// Around x*: as far as x* is large, or as the unknowns are where they have one scale. A wide box
// also holds the start and never binds.
Bounds box_around(const Vector& truth, const Problem& plain, bool is_active) {
  constexpr Real kWide = 10, kBelow = 0.1;
  constexpr Index kEvery = 3;
  const auto k = static_cast<Real>(truth.size());
  const Real common = plain.start_scale() == StartScale::own ? 0 : truth.norm() / std::sqrt(k);
  Vector radius = truth.cwiseAbs().cwiseMax(common);
  for (Real& each : radius) each = each > 0 ? each : 1;
  if (is_active) {
    Bounds box{truth - radius, truth + radius};
    for (Index i = 0; i < truth.size(); i += kEvery) box.upper[i] = truth[i] - kBelow * radius[i];
    return box;
  }
  radius = kWide * radius.cwiseMax((plain.start() - truth).cwiseAbs());
  return {truth - radius, truth + radius, false};
}

constexpr Index kMostFitted = 512;  // unknowns, and of J the smaller of its sizes

// The result of a least-squares fit from x, by Levenberg and Marquardt's method. Components that a
// step takes out of the bounds stop there, and the others step again.
struct Fit {
  Real loss;
  Matrix x;  // (k, 1)
};
Fit fit_from(const Problem& problem, Vector x) {
  constexpr int kMost = 1000;  // a flow with viscosity takes hundreds to fit its noise
  Point at, trial;
  Matrix J;
  Vector r(problem.residuals()), sizes, step, next, gradient;
  Real damping = 1e-3;
  bool has_moved = true;
  const Bounds* const bounds = problem.bounds();
  if (bounds) x = bounds->nearest(x);
  problem.forward(x, at);
  for (int i = 0; i < kMost && damping < 1e12; ++i) {
    if (std::exchange(has_moved, false)) {
      problem.jacobian(J, at);
      problem.residual(at, r);
      if (bounds) {
        gradient = J.transpose() * r;
        for (Index j = 0; j < x.size(); ++j)
          if (bounds->is_active(x, gradient, j)) J.col(j).setZero();
      }
      sizes = J.colwise().norm();
      sizes = sizes.array().max(1e-12 * sizes.maxCoeff());
    }
    Matrix stacked(J.rows() + J.cols(), J.cols());
    stacked << J, (std::sqrt(damping) * sizes).asDiagonal().toDenseMatrix();
    Vector right = Vector::Zero(stacked.rows());
    right.head(r.size()) = -r;
    Vector held = Vector::Zero(x.size());
    bool is_inside = false, is_solved = true;
    while (!is_inside && (is_solved = least_squares(stacked, right, 0, step))) {
      is_inside = true;
      next = x + held + step;
      for (Index j = 0; bounds && j < x.size(); ++j) {
        const Real bound = std::clamp(next[j], bounds->lower[j], bounds->upper[j]);
        auto column = stacked.col(j).head(r.size());
        if (bound == next[j] || column.isZero(0)) continue;
        is_inside = false;
        held[j] = bound - x[j];
        right.head(r.size()) -= held[j] * column;
        column.setZero();
      }
    }
    if (!is_solved) break;
    if (bounds) next = bounds->nearest(next);
    problem.forward(next, trial);
    has_moved = trial.loss < at.loss;
    damping = has_moved ? damping / 8 : damping * 8;
    if (!has_moved) continue;
    x = next;
    std::swap(at, trial);
  }
  return {at.loss, x};
}

// The least error in x, as the problem measures it, of a truncated-SVD solution with the Jacobian
// at x*, from the standard start x₀:
//   x_c = x₀ + Σ_{i ≤ c} (vᵢᵀ (x* − x₀) + uᵢᵀ e / σᵢ) vᵢ,   e = y* − P(x*)
// The run's own start is no worse than itself.
Real truncated_floor(const Problem& problem, const Vector& truth) {
  Point at;
  Matrix J;
  problem.forward(truth, at);
  problem.jacobian(J, at);
  const Vector e = (problem.target() - at.y).reshaped();
  Svd svd;
  require(thin_svd(J, svd), "the Jacobian at x* has no singular value decomposition");
  const auto error = [&](const Vector& x) {
    const Real own = problem.x_error(x);
    return std::isfinite(own) ? own : (x - truth).norm();
  };
  Vector x = problem.standard_start();
  const Vector data = svd.U.transpose() * e, missing = svd.Vt * (truth - x);
  Real least = std::min(error(problem.start()), error(x));
  for (Index i = 0; i < data.size() && svd.sigma[i] > 0; ++i) {
    x += (missing[i] + data[i] / svd.sigma[i]) * svd.Vt.row(i).transpose();
    least = std::min(least, error(x));
  }
  return least;
}

}  // namespace

bool has_fitted_minimum(const OptionValues& options) {
  return options.number("noise", 0) > 0 || options.number("tikhonov", 0) > 0 ||
         options.text("bounds") == "active" || !options.text("model").empty();
}

OptionTable feature_table(const OptionTable& own) {
  OptionTable table = option_table<Features>();
  std::erase_if(table, [&](const OptionField& field) {
    return std::ranges::find(own, field.name, &OptionField::name) != own.end();
  });
  return table;
}

namespace {

// Errors in x as distances from the fit, in its standard deviations.
Problem judged_by_fit(Problem fitted, const Vector& fit) {
  Point at;
  Matrix J;
  fitted.forward(fit, at);
  fitted.jacobian(J, at);
  J *= std::sqrt(static_cast<Real>(J.rows())) / *fitted.noise_level();
  const Real extent = (J * (fitted.standard_start() - fit)).norm();
  ProblemParts parts = std::move(fitted).parts();
  if (!parts.made_from) parts.made_from = parts.truth;
  parts.truth = fit;
  parts.x_error = [J, fit](BatchRef x, const Batch&) { return (J * (x.col(0) - fit)).norm(); };
  parts.x_scale = extent;
  parts.x_floor = [](const Batch&) { return kNearFit / x_goal(0, 0, 1); };
  return Problem(std::move(parts));
}

// Those that change the data, the unknowns or the loss.
Problem with_other_data(Problem plain, const Features& features, const Draw& draw,
                        const std::optional<Matrix>& target) {
  require(features.tikhonov == 0 || plain.is_least_squares(),
          "tikhonov requires a least-squares loss, which this problem does not have");
  require(features.fail == 0 || plain.samples() == 1, "fail requires a problem of one sample");
  require(features.tikhonov > 0 || features.order == 0, "order=1 requires tikhonov above 0");
  require(features.noise > 0 || features.noise_kind == "gaussian",
          "noise-kind requires noise above 0");
  require(features.goal == "truth" ||
              (features.noise > 0 && features.tikhonov == 0 && features.bounds == "none" &&
               features.scale == 1 && !features.rotate),
          "goal=fit requires noise above 0, and neither tikhonov, bounds, scale nor rotate");

  const Index k = plain.inputs(), m = plain.outputs();
  const bool is_inexact = features.noise > 0 || features.digits > 0 || target.has_value();
  const bool is_linearized = plain.made_from() && plain.is_least_squares() &&
                             std::min(k, m) <= kMostFitted &&
                             plain.offers().contains(Oracle::jacobian);
  const bool is_fitted = is_linearized && k <= kMostFitted;
  const Vector truth = plain.made_from() ? Vector(plain.made_from()->reshaped()) : Vector();
  const bool is_bounded = features.bounds != "none", is_bound = features.bounds == "active";
  require(!is_bounded || (plain.made_from() && !plain.bounds()),
          "bounds requires a problem that has a known x*, and no bounds of its own");
  require(!features.rotate || (!is_bounded && !plain.bounds()),
          "rotate=true and bounds cannot be combined: after a rotation, the box is not a set of "
          "bounds on single unknowns");
  const std::optional<Real> least = plain.minimum();
  const Real x_scale = plain.x_scale(plain.batch());

  std::optional<Bounds> box;
  if (is_bounded) box = box_around(truth, plain, is_bound);
  ProblemParts parts = std::move(plain).parts();
  parts.x_scale = x_scale;
  if (box) parts.bounds = std::move(box);
  if (is_bound) parts.aim = Aim::loss;
  Real model_error = 0;
  if (target) {
    require(target->rows() == m, "the options in model must not change the number of observations");
    model_error = (parts.target - *target).norm();
    parts.target = *target;
  }
  if (features.noise > 0) {
    const Vector noise = noise_of(features, parts.target.reshaped(), draw.stream("noise"));
    const Real level = features.noise * size_of_noise(features.noise_kind) * parts.target.norm();
    parts.noise_level = std::hypot(level, parts.noise_level.value_or(0), model_error);
    parts.target += noise;
  }
  if (features.digits > 0) round_values(parts.target, features.digits);
  if (is_inexact) parts.x_floor = {};
  if (is_inexact && is_linearized) {
    Problem inexact(std::move(parts));
    const Real floor = truncated_floor(inexact, truth);
    parts = std::move(inexact).parts();
    parts.x_floor = [floor](const Batch&) { return floor; };
  }
  Map map = map_of(features, k, draw);
  const bool is_mapped = !map.is_identity();
  std::vector<Vector> free{parts.start.drawn, parts.start.standard};
  if (truth.size() > 0) free.push_back(truth);
  FailingLayers layers = layers_of(features.fail, free.back(), free, draw.stream("fail"));
  if (is_mapped || features.digits > 0 || features.tikhonov > 0 || features.fail > 0)
    wrap(parts, std::move(map), std::move(layers), features);
  if (features.noise == 0 && !target && features.tikhonov == 0 && !is_bound)
    return Problem(std::move(parts));
  parts.minimum.reset();
  parts.minimum_error = 0;
  Problem featured(std::move(parts));
  require((is_fitted && least) || features.goal == "truth", [&] {
    return fmt::format("goal=fit requires exact data of a known x* and at most {} unknowns",
                       kMostFitted);
  });
  if (!is_fitted || !least) return featured;
  const Fit fit = fit_from(featured, featured.made_from()->reshaped());
  featured.set_minimum(fit.loss);
  if (is_bound) featured.set_x_floor(featured.x_error(fit.x));
  return features.goal == "fit" ? judged_by_fit(std::move(featured), fit.x) : std::move(featured);
}

// One scale per unknown: |x₀|; where that is 0 the width of its bounds; else 1/‖∂y/∂xᵢ‖ at x₀.
Vector scales_of_unknowns(const Problem& problem) {
  const Vector& start = problem.start();
  Vector scales = start.cwiseAbs();
  Point at;
  for (Index i = 0; i < start.size(); ++i) {
    if (is_logarithm(problem, i)) scales[i] = 1;
    if (scales[i] > 0) continue;
    if (problem.bounds()) scales[i] = problem.bounds()->upper[i] - problem.bounds()->lower[i];
    if (scales[i] > 0 && std::isfinite(scales[i])) continue;
    if (at.batch == nullptr) problem.forward(start, at);
    constexpr int kTries = 4;
    constexpr Real kSmall = 0.1;  // of y: a step that changes more of it is no derivative
    const Real longest = 1e-3 * sizes_of_unknowns(start)[i];
    const bool is_at_top = problem.bounds() && problem.bounds()->upper[i] < longest;
    scales[i] = 1000 * longest;
    Real step = longest, change = 0;
    for (int tried = 0; tried < kTries; ++tried, step *= 1e-3) {
      Vector x = start;
      x[i] = is_at_top ? -step : step;
      Point moved;
      problem.forward(x, moved);
      change = (moved.y - at.y).norm();
      if (change > 0 && std::isfinite(change)) scales[i] = step / change;
      if (!(at.y.norm() > 0) || change <= kSmall * at.y.norm()) break;
    }
  }
  return scales;
}

}  // namespace

Problem with_features(Problem plain, const OptionValues& options, const Draw& draw,
                      const std::optional<Matrix>& target) {
  if (options.empty()) return plain;
  const Features features =
      read_options<Features>(complete_options(option_table<Features>(), "features", options));
  require(!plain.is_learned(),
          "noise, model, scale, rotate, digits, tikhonov, order, fail, jitter, derivatives "
          "and difference-step require mode=direct");
  Problem featured =
      with_model(with_other_data(std::move(plain), features, draw, target), features, draw);
  const bool has_step = !features.difference_step.empty();
  if (features.jitter == 0 && features.derivatives == "exact" && !has_step) return featured;
  ProblemParts parts = std::move(featured).parts();
  if (features.jitter > 0) parts.jitter = {features.jitter, draw.stream("jitter")};
  if (features.derivatives != "exact") {
    replace_derivatives(parts, features.derivatives, false, features.difference_step);
  } else if (has_step) {  // of a script that has asked for differences
    require(remove_differences(parts).has_value(),
            "difference-step is the step of derivatives=forward, derivatives=central or a script's "
            "differences=True");
    replace_derivatives(parts, "central", true, features.difference_step);
  }
  return Problem(std::move(parts));
}

Problem with_scaled_unknowns(Problem plain) {
  const bool declares_scales = plain.start_scale() == StartScale::own || plain.bounds();
  if (!declares_scales || !plain.has_identity_network() || plain.samples() != 1 || plain.field())
    return plain;
  Map map{.scales = scales_of_unknowns(plain)};
  const Real x_scale = plain.x_scale(plain.batch());
  const bool has_model = plain.model() != nullptr;
  ProblemParts parts = std::move(plain).parts();
  if (!has_model) parts.own_units = {.scales = map.scales, .bounds = parts.bounds};
  map.box = parts.bounds;
  parts.x_scale = x_scale;
  const auto names = parts.names, units = parts.units;
  const Series series = parts.series;  // a problem with such an option has it of its calls alone
  wrap(parts, std::move(map), {}, Features{});
  parts.names = names;
  parts.units = units;
  parts.series = series;
  return Problem(std::move(parts));
}

}  // namespace isoline::problems
