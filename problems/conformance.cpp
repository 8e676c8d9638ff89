// Measures the required properties of every problem.
#include "problems/conformance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "core/decompose.h"
#include "core/differences.h"
#include "core/failures.h"
#include "core/foreign/evaluations.h"
#include "core/workspace.h"
#include "problems/differences.h"

namespace isoline::problems {
namespace {

// The steps of Taylor's remainder: the first, and each as a part of the one before.
struct Steps {
  Real first, ratio;
  int count;  // after the first
};
constexpr Steps kSteps = {1e-2, 0.5, 16}, kFewSteps = {1e-2, 0.125, 3};
constexpr Real kRoom = 0.05;  // of a box, between the point and a bound
constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();
constexpr const char* kRounding = "rounding in double precision, with a margin for cancellation";
constexpr const char* kDifferences =
    "central differences, whose step h follows from the noise of y: their error is about h²/6 times the "
    "third derivative, plus 1/h times that noise";

// One problem, one point, and what is measured there. Directions and steps are relative to the
// sizes of the unknowns where the scale is each unknown's own.
class Examination {
 public:
  Examination(const Problem& problem, StartScale scale, RandomStream& stream)
      : problem_(problem), scale_(scale), stream_(stream), sink_(*failures_) {
    sizes_ = scale == StartScale::own ? sizes_of_unknowns(problem.start())
                                      : Vector::Ones(problem.unknowns());
    if (const Bounds* bounds = problem.bounds())  // steps stay inside; a fixed unknown has none
      sizes_ = sizes_.cwiseMin(kRoom / kSteps.first * (bounds->upper - bounds->lower));
    constexpr int kTries = 20;  // a problem may have no value here and there
    if (problem.is_elsewhere()) {
      const double begin = call_clock();
      if (!start().y.allFinite()) return;
      call_seconds_ = call_clock() - begin;
    }
    const Products products = problem.products();
    const bool has_own =
        (products.has_pushforward || products.has_pullback) && !products.are_differences;
    if (is_slow() && !has_own && start().y.allFinite()) {  // the run has the same calls
      theta_ = problem.start();
      problem_.forward(theta_, at_);
    }
    for (int i = 0; i < kTries && (at_.y.size() == 0 || !at_.y.allFinite()); ++i) {
      const double begin = call_clock();
      theta_ = near_start();
      problem_.forward(theta_, at_);
      if (i == 0 && problem.is_elsewhere())  // the first call may have compiled something
        call_seconds_ = std::min(call_seconds_, call_clock() - begin);
    }
    piece_ = piece_of(at_);
    if (!problem_.is_elsewhere() || is_slow() || !at_.y.allFinite() || !start().y.allFinite())
      return;
    noise_ = relative_noise(problem_, problem_.start());
    h_ = central_step(noise_);
  }

  std::vector<Finding> findings;
  bool is_slow() const { return problem_.is_elsewhere() && call_seconds_ >= kSlowSeconds; }
  double call_seconds() const { return call_seconds_; }

  // Again in other directions where a call failed: a program may fail here and there.
  void make(void (Examination::*check)()) {
    constexpr int kTries = 5;
    for (int i = 0; i < kTries; ++i) {
      const auto before = std::ssize(findings);
      const std::int64_t failed = failures_->total;
      (this->*check)();
      const auto made = findings.begin() + before;
      if (std::all_of(made, findings.end(), std::mem_fn(&Finding::holds))) return;
      if (failures_->total == failed || i + 1 == kTries) return;
      findings.erase(made, findings.end());
    }
  }

  // NaN differs from itself, which would read as randomness.
  bool is_finite() {
    const bool has_target = problem_.target().allFinite();
    const bool has_start = !problem_.has_identity_network() || start().y.allFinite();
    const bool has_values = has_start && at_.y.size() > 0 && at_.y.allFinite();
    if (!has_start)
      add("y is finite at the start", 1, 0,
          "each method begins there, so the call at the starting point must succeed" +
              first_not_finite(start().y));
    else if (!has_values)
      add("y is finite near the start", 1, 0, "20 sampled points near the start have no finite y");
    if (!has_target) add("y* is finite", 1, 0, "the target must consist of finite numbers");
    return has_values && has_target;
  }

  // The effects of the unknowns on y, and how many of their combinations have one. Always
  // holds: a model may have an unknown too many.
  void rank() {
    constexpr Index kMostUnknowns = 64;
    const Index n = problem_.unknowns();
    if (!problem_.has_identity_network() || problem_.samples() != 1 || n > kMostUnknowns ||
        is_slow())
      return;
    Matrix J;
    if (offers(Oracle::jacobian))
      problem_.jacobian(J, at_);
    else
      J = by_differences();
    if (!J.allFinite()) return;
    const Matrix sized = J * sizes_.cwiseMax(theta_.cwiseAbs()).asDiagonal();
    const bool is_exact = offers(Oracle::jacobian) && !problem_.products().are_differences;
    const Real error = is_exact ? 100 * kEpsilon : 4 * std::sqrt(noise_);
    const bool is_central = offers(Oracle::jacobian);
    const Real step = is_central ? central_step(noise_) : forward_step(noise_);
    const Real unseen = is_exact ? error : 2 * noise_ / step;  // of the size of y
    std::string without;
    std::vector<Index> effective;
    for (Index j = 0; j < n; ++j) {
      if (sizes_[j] == 0) continue;
      if (sized.col(j).norm() > unseen * at_.y.norm())
        effective.push_back(j);
      else
        without += (without.empty() ? "" : ", ") + name_of_unknown(problem_.names(), j);
    }
    Vector sigma;
    Index found = 0;
    if (!effective.empty()) {
      Matrix scaled = sized(Eigen::all, effective);
      scaled.array().rowwise() /= scaled.colwise().norm().array();
      if (!singular_values(scaled, sigma)) return;
      found = (sigma.array() > error * sigma[0]).count();
    }
    add(fmt::format("rank of J near the start: {} of {}{}", found, n,
                    without.empty() ? ""
                    : without.find(", ") == std::string::npos
                        ? "; " + without + " has no effect on y"
                        : "; " + without + " have no effect on y"),
        static_cast<Real>(std::min(n, J.rows()) - found), static_cast<Real>(n),
        "an unknown without effect keeps its value");
  }

  void repeatability() {
    const Afresh afresh;
    const Point again = point_at(theta_);
    add("forward gives the same bits twice",
        same_bits(again.y, at_.y) && again.loss == at_.loss ? 0 : 1, 0,
        "forward must not be random");
  }

  // At other points, a product may use random numbers of its own, or depend on earlier calls. The
  // values of differences are those of forward.
  void purity() {
    const Vector v = direction();
    const Matrix u = cotangent();
    const bool has_own = !is_slow() || !problem_.products().are_differences;
    const bool pushes = has_own && offers(Oracle::pushforward);
    const bool pulls = has_own && offers(Oracle::pullback);
    const Matrix Jv = pushes ? push(v, at_) : Matrix();
    const Matrix JTu = pulls ? Matrix(pull(u, at_)) : Matrix();
    start();
    const Afresh afresh;
    Point again = point_at(theta_);
    bool same = same_bits(again.y, at_.y);
    if (pushes) same = same && same_bits(push(v, again), Jv);
    if (pulls) same = same && same_bits(pull(u, again), JTu);
    add("the same call gives the same bits after other calls", same ? 0 : 1, 0,
        "runs must be repeatable bit for bit");
  }

  void adjoint() {
    const Vector v = direction();
    const Matrix u = cotangent();
    const Matrix Jv = push(v, at_);
    const Real scale = u.norm() * Jv.norm() + sized(pull(u, at_)).norm();  // v has norm 1 so
    const Real gap = std::abs(u.cwiseProduct(Jv).sum() - v.dot(pull(u, at_)));
    const bool is_single = problem_.network().is_single_precision();
    add("⟨u, J v⟩ = ⟨Jᵀu, v⟩", relative(gap, scale), is_single ? 1e-5 : product_limit(),
        is_single ? "rounding in single precision, with a margin for cancellation"
                  : product_reason());
  }

  // ‖y(θ + h v) − y(θ) − h J v‖ falls by 4 if h is halved. The median is over the steps whose
  // remainder is well above rounding; a linear problem has none.
  void taylor() {
    Real h = steps().first;
    const Vector v = smooth_direction(h, steps().count);
    const Matrix Jv = push(v, at_);
    const Real floor = remainder_floor() * (at_.y.norm() + Jv.norm());
    const Real slope = order_of([&](Real step) { return remainder(v, Jv, step); }, h, floor);
    add("y(x + h v) − y(x) − h J v falls as h² (deviation of the exponent)", std::abs(slope - 2),
        0.1, "a wrong J v gives exponent 1; the third derivative changes it by O(h)");
  }

  // The same for Jᵀu, for a problem without J v: |⟨u, y(θ + h v) − y(θ)⟩ − h ⟨Jᵀu, v⟩|.
  void taylor_of_pullback() {
    Real h = steps().first;
    const Vector v = smooth_direction(h, steps().count);
    const Matrix u = cotangent() / std::sqrt(static_cast<Real>(problem_.residuals()));
    const Real change = pull(u, at_).dot(v);
    const Real floor = remainder_floor() * (u.norm() * at_.y.norm() + std::abs(change));
    const auto remainder_at = [&](Real step) {
      const Point at = point_at(theta_ + step * v);
      return std::abs(u.cwiseProduct(at.y - at_.y).sum() - step * change);
    };
    const Real slope = order_of(remainder_at, h, floor);
    add("⟨u, y(x + h v) − y(x)⟩ − h ⟨Jᵀu, v⟩ falls as h² (deviation of the exponent)",
        std::abs(slope - 2), 0.1,
        "a wrong Jᵀu gives exponent 1; the third derivative changes it by O(h)");
  }

  void gradient() {
    const Vector v = smooth_direction();
    const Vector g = loss_gradient(at_);
    if (const Real measured = problem_.products().noise; is_slow() && measured > 0)
      h_ = central_step(noise_ = measured);  // by the calls of the differences in g
    const Real difference = (loss(theta_ + h_ * v) - loss(theta_ - h_ * v)) / (2 * h_);
    const Real scale = sized(g).norm() + std::abs(at_.loss);
    add("⟨∇L, v⟩ equals the change of L along v", relative(std::abs(difference - g.dot(v)), scale),
        std::max(problem_.products().are_differences ? 1e-3 : 1e-6, quotient_error()),
        kDifferences);
  }

  void jacobian() {
    if (!offers(Oracle::jacobian) || !is_dense_feasible(problem_.residuals() * problem_.unknowns()))
      return;
    const Vector v = direction();
    const Matrix u = cotangent();
    Matrix J;
    problem_.jacobian(J, at_);
    const Vector Jv = offers(Oracle::pushforward) ? Vector(push(v, at_).reshaped()) : Vector();
    const Vector JTu = offers(Oracle::pullback) ? pull(u, at_) : Vector();
    if (offers(Oracle::pushforward))
      add("J v from the matrix equals J v from the product",
          relative((J * v - Jv).norm(), Jv.norm()), product_limit(), product_reason());
    if (offers(Oracle::pullback))
      add("Jᵀu from the matrix equals Jᵀu from the product",
          relative(sized(J.transpose() * u.reshaped() - JTu).norm(), sized(JTu).norm()),
          product_limit(), product_reason());
  }

  void sparse_jacobian() {
    if (!offers(Oracle::sparse_jacobian)) return;
    const SparsePattern& pattern = *problem_.sparse_pattern();
    const Vector v = direction();
    const Matrix u = cotangent();
    Vector values, Jv(problem_.residuals()), JTu(problem_.unknowns());
    problem_.sparse_jacobian(values, at_);
    pattern.multiply(values.data(), v, Jv);
    pattern.multiply_transposed(values.data(), u.reshaped(), JTu);
    if (offers(Oracle::pushforward)) {
      const Vector pushed = push(v, at_).reshaped();
      add("J v from the sparse values equals J v from the product",
          relative((Jv - pushed).norm(), pushed.norm()), product_limit(), product_reason());
    }
    if (offers(Oracle::pullback)) {
      const Vector pulled = pull(u, at_);
      add("Jᵀu from the sparse values equals Jᵀu from the product",
          relative(sized(JTu - pulled).norm(), sized(pulled).norm()), product_limit(),
          product_reason());
    }
  }

  void curvature() {
    const Index k = problem_.inputs();
    if (!offers(Oracle::curvature) || !is_dense_feasible(k * k * problem_.samples())) return;
    const Vector v = smooth_direction();
    const Matrix w = cotangent();
    Matrix H(k, k * problem_.samples());
    problem_.curvature(w, H, at_);
    Real asymmetry = 0;
    for (Index b = 0; b < problem_.samples(); ++b)
      asymmetry += (H.middleCols(b * k, k) - H.middleCols(b * k, k).transpose()).norm();
    add("Σ wᵢ ∇²Pᵢ is symmetric", relative(asymmetry, H.norm()), 1e-14, kRounding);
    const Vector JTw = pull(w, at_);
    const Vector difference = change_along(v, [&](Point& at) { return pull(w, at); });
    const Vector Hv = H * v;
    add("Σ wᵢ ∇²Pᵢ v equals the change of Jᵀw along v",
        relative(sized(difference - Hv).norm(), sized(Hv).norm() + sized(JTw).norm()), 1e-6,
        kDifferences);
  }

  void hessian() {
    const Index n = problem_.unknowns();
    if (!offers(Oracle::hessian) || !is_dense_feasible(n * n)) return;
    const Vector v = smooth_direction();
    Matrix H;
    problem_.hessian(H, at_);
    add_change_of_gradient("∇²L v equals the change of ∇L along v", v, H * v);
  }

  void hessian_product() {
    if (!offers(Oracle::hessian_product)) return;
    const Vector v = smooth_direction();
    Vector Hv(problem_.unknowns());
    problem_.hessian_product(v, Hv, at_);
    add_change_of_gradient("the product with ∇²L equals the change of ∇L along v", v, Hv);
  }

  // For a y that some x reaches. Uses the physics alone, without the network.
  void inverse() {
    if (problem_.inverse_kind() != Inverse::exact) return;
    const Point reached = point_at(near_start());
    Point back;
    Matrix x(problem_.inputs(), problem_.samples());
    const bool success = problem_.local_inverse(reached.y, x, at_).all();
    add("the inverse succeeds where y is reachable", success ? 0 : 1, 0,
        "the inverse is declared exact");
    problem_.physics_forward(x, problem_.batch(), back);
    add("P(P⁻¹(y)) = y", relative((back.y - reached.y).norm(), reached.y.norm()), 1e-10,
        "rounding, amplified by the condition of P⁻¹");
  }

  // The properties of a damped inverse: no step if y* is reached, never a step away from y*, and an
  // inversion of P where the data carry evidence, as they do for an input that P has smoothed
  // before.
  void damped_inverse() {
    if (problem_.inverse_kind() != Inverse::damped) return;
    Matrix x(problem_.inputs(), problem_.samples());
    problem_.local_inverse(at_.y, x, at_);
    add("the damped inverse keeps an x that already gives y",
        relative((x - at_.x()).norm(), at_.x().norm()), 1e-12, kRounding);
    problem_.local_inverse(problem_.target(), x, at_);
    Point moved;
    problem_.physics_forward(x, problem_.batch(), moved);
    const Real before = (at_.y - problem_.target()).norm();
    add("the damped inverse does not move y away from y*",
        (moved.y - problem_.target()).norm() / before - 1, 1e-12, kRounding);
    const Matrix wanted = smoothed();
    Point reached, nowhere;
    problem_.physics_forward(wanted, problem_.batch(), reached);
    problem_.physics_forward(Matrix::Zero(wanted.rows(), wanted.cols()), problem_.batch(), nowhere);
    problem_.local_inverse(reached.y, x, nowhere);
    add("the damped inverse undoes P on a smoothed x", relative((x - wanted).norm(), wanted.norm()),
        1e-3, "the inverse suppresses modes below its assumed noise, a small part");
  }

  void solution() {
    const Point& start = this->start();
    if (problem_.minimum()) {
      const Real minimum = *problem_.minimum(), error = problem_.minimum_error();
      add("the loss is above the declared minimum around the start",
          std::max(minimum - at_.loss, minimum - start.loss), error,
          "the minimum is the least attainable loss, within its declared error");
      if (problem_.truth() && problem_.has_identity_network())
        add("the truth attains the declared minimum",
            relative(std::abs(loss(problem_.truth()->reshaped()) - minimum), start.loss),
            1e-13 + (error > 0 ? error / start.loss : 0),
            "squared residuals are zero except for rounding and the declared error");
    }
    if (problem_.aim() == Aim::x)
      add("the scale of x is known", problem_.x_scale(problem_.batch()) > 0 ? 0 : 1, 0,
          "errors in x are relative to it");
    if (problem_.truth() && !std::isnan(problem_.x_error(*problem_.truth())))
      add("the error in x of the truth is 0, or at most its floor",
          (problem_.x_error(*problem_.truth()) -
           (problem_.minimum() ? 0 : problem_.x_floor(problem_.batch()))) /
              std::max(1.0, problem_.truth()->norm()),
          1e-14, kRounding);
  }

 private:
  // By which power of h the remainder falls: the median over the steps that stay above `floor`.
  template <class Remainder>
  Real order_of(const Remainder& remainder, Real h, Real floor) const {
    std::vector<Real> slopes;
    Real previous = remainder(h);
    for (int i = 0; i < steps().count; ++i) {
      h *= steps().ratio;
      const Real now = remainder(h);
      if (now > floor && std::isfinite(previous))  // a call may fail
        slopes.push_back(std::log(now / previous) / std::log(steps().ratio));
      previous = now;
    }
    std::nth_element(slopes.begin(), slopes.begin() + static_cast<Index>(slopes.size() / 2),
                     slopes.end());
    return slopes.empty() ? 2 : slopes[slopes.size() / 2];
  }
  static std::string first_not_finite(const Matrix& y) {
    for (Index i = 0; i < y.size(); ++i)
      if (!std::isfinite(y.reshaped()[i]))
        return fmt::format("; y{} is {}", i + 1, y.reshaped()[i]);
    return "";
  }
  static bool same_bits(const Matrix& a, const Matrix& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), sizeof(Real) * static_cast<std::size_t>(a.size())) == 0;
  }
  static bool is_dense_feasible(Index entries) { return entries <= 4'000'000; }
  static Real relative(Real gap, Real scale) { return gap == 0 ? 0 : gap / scale; }
  // Differences agree with each other as far as they have digits.
  Real product_limit() const {
    return problem_.products().are_differences ? std::max(1e-5, quotient_error()) : 1e-12;
  }
  // Below, the remainder of Taylor's formula shows the error of y and of J v.
  Real remainder_floor() const {
    const bool is_noisy = noise_ > 10 * kEpsilon || problem_.products().are_differences;
    return is_noisy ? 10 * (noise_ + quotient_error() * kSteps.first) : 1e4 * kEpsilon;
  }
  // The error of central differences with steps by the noise of y, with a margin for its direction.
  Real quotient_error() const { return 100 * std::pow(noise_, 2.0 / 3); }
  Matrix by_differences() const {
    Matrix J(problem_.residuals(), problem_.unknowns());
    const Vector sizes = sizes_.cwiseMax(theta_.cwiseAbs());
    const Bounds* const bounds = problem_.bounds();
    const Vector y0 = at_.y.reshaped();
    for (Index j = 0; j < J.cols(); ++j) {
      const Room room =
          bounds ? Room{bounds->upper[j] - theta_[j], theta_[j] - bounds->lower[j]} : Room{};
      const Real h = forward_step(noise_) * sizes[j];
      J.col(j) = quotient_of_calls(difference_offsets(h, false, room.up, room.down), room, y0,
                                   [&](Real t) -> Vector {
                                     Vector moved = theta_;
                                     moved[j] += t;
                                     return point_at(moved).y.reshaped();
                                   });
    }
    return J;
  }
  const char* product_reason() const {
    return problem_.products().are_differences ? kDifferences : kRounding;
  }
  bool offers(Oracle oracle) const { return problem_.offers().contains(oracle); }
  void add(std::string property, Real figure, Real limit, std::string reason) {
    findings.push_back({std::move(property), figure, limit, std::move(reason)});
    const std::int64_t before = std::exchange(reported_, failures_->total);
    if (findings.back().holds() || failures_->total == before || failures_->kept == 0) return;
    const int last = failures_->kept - 1;
    findings.back().reason +=
        fmt::format("; the call at x = ({}) failed: {}", fmt::join(failures_->point(last), ", "),
                    std::string_view(failures_->reason[last]));
  }

  // A direction that crosses no nondifferentiable point of the problem, at any of the points ±h,
  // ±h/2, … along it. Others are resampled; after some tries, over shorter distances, returned in
  // h.
  Vector smooth_direction(Real& h, int halvings) {
    constexpr int kTries = 20, kShortenings = 6;
    Vector v;
    for (int i = 0; i < kTries * kShortenings; ++i) {
      if (i > 0 && i % kTries == 0) h /= 10;
      v = direction();
      if (is_smooth_along(v, h, halvings)) return v;
    }
    add("a direction without nondifferentiable points exists", 1, 0,
        "the differentiable pieces that the problem declares must have an extent");
    return v;
  }
  Vector smooth_direction() { return smooth_direction(h_, 0); }
  bool is_smooth_along(const Vector& v, Real h, int halvings) const {
    if (!has_pieces(at_)) return true;
    Point at;
    for (int i = 0; i <= halvings; ++i, h /= 2)
      for (const Real sign : {-1.0, 1.0}) {
        problem_.forward(theta_ + sign * h * v, at);
        if (piece_of(at) != piece_) return false;
      }
    return true;
  }
  static bool has_pieces(const Point& at) {
    return dynamic_cast<Pieces*>(at.physics.own.get()) != nullptr ||
           dynamic_cast<Pieces*>(at.network.own.get()) != nullptr;
  }
  static std::uint64_t piece_of(const Point& at) {
    PieceDigest digest;
    for (Scratch* own : {at.physics.own.get(), at.network.own.get()})
      if (auto* pieces = dynamic_cast<Pieces*>(own)) pieces->add_choices(digest);
    return digest.value();
  }

  Vector direction() { return sized(stream_.normal_vector(problem_.unknowns()).normalized()); }
  Vector sized(const Vector& v) const { return v.cwiseProduct(sizes_); }
  Matrix cotangent() {
    return stream_.normal_vector(problem_.residuals())
        .reshaped(problem_.outputs(), problem_.samples());
  }
  Vector near_start() {
    constexpr Real kOfSize = 0.02;  // of an unknown
    Vector x = near(problem_.start(), scale_, stream_);
    const Bounds* const bounds = problem_.bounds();
    for (Index i = 0; bounds && i < x.size(); ++i) {
      const Real lower = bounds->lower[i], upper = bounds->upper[i];
      const Real room =
          std::min(kRoom * (upper - lower), kOfSize * std::max(sizes_[i], std::abs(x[i])));
      x[i] = std::clamp(x[i], lower + room, std::max(upper - room, lower + room));
    }
    return x;
  }
  const Steps& steps() const { return is_slow() ? kFewSteps : kSteps; }
  const Point& start() {
    if (start_.y.size() == 0) problem_.forward(problem_.start(), start_);
    return start_;
  }

  // (PᵀP)³ of noise of 0.1
  Matrix smoothed() {
    Matrix x = 0.1 * stream_.normal_vector(problem_.inputs() * problem_.samples())
                         .reshaped(problem_.inputs(), problem_.samples());
    Point at;
    for (int i = 0; i < 3; ++i) {
      problem_.physics_forward(x, problem_.batch(), at);
      problem_.physics_pullback(at.y, x, at);
    }
    return x;
  }

  Matrix push(VectorRef v, Point& at) const {
    Matrix Jv(problem_.outputs(), problem_.samples());
    problem_.pushforward(v, Jv, at);
    return Jv;
  }
  Vector pull(BatchRef w, Point& at) const {
    Vector JTw(problem_.unknowns());
    problem_.pullback(w, JTw, at);
    return JTw;
  }
  Vector loss_gradient(Point& at) const {
    Matrix g(problem_.outputs(), problem_.samples());
    problem_.cotangent(at, g);
    return pull(g, at);
  }
  Point point_at(VectorRef theta) const {
    Point at;
    problem_.forward(theta, at);
    return at;
  }
  Real loss(VectorRef theta) const { return point_at(theta).loss; }
  Real remainder(VectorRef v, BatchRef Jv, Real h) const {
    return (point_at(theta_ + h * v).y - at_.y - h * Jv).norm();
  }
  template <class Quantity>
  Vector change_along(const Vector& v, const Quantity& of) const {
    Point plus = point_at(theta_ + h_ * v), minus = point_at(theta_ - h_ * v);
    return (of(plus) - of(minus)) / (2 * h_);
  }
  void add_change_of_gradient(std::string property, const Vector& v, const Vector& Hv) {
    const Vector difference = change_along(v, [&](Point& at) { return loss_gradient(at); });
    add(std::move(property),
        relative(sized(difference - Hv).norm(),
                 sized(Hv).norm() + sized(loss_gradient(at_)).norm()),
        1e-6, kDifferences);
  }

  const Problem& problem_;
  const StartScale scale_;
  RandomStream& stream_;
  std::unique_ptr<FailedEvaluations> failures_ = std::make_unique<FailedEvaluations>();
  FailureSink sink_;
  std::int64_t reported_ = 0;  // of the failures
  Real noise_ = kEpsilon;      // of y in a call, relative to it
  Vector sizes_;               // (n), of the unknowns
  Vector theta_;
  Point at_;                      // the linearization at theta_
  Point start_;                   // that of the problem, once it is needed
  double call_seconds_ = 0;       // of a forward
  std::uint64_t piece_ = 0;       // that it lies on
  Real h_ = std::cbrt(kEpsilon);  // balances truncation and rounding
};

using Check = void (Examination::*)();

// Purity includes repeatability, at the price of one call more.
std::vector<Check> checks_of(const Problem& problem, bool is_slow) {
  std::vector<Check> checks;
  if (!is_slow) checks.push_back(&Examination::repeatability);
  if (problem.is_elsewhere()) checks.push_back(&Examination::purity);
  const Products has = problem.products();
  if (is_slow && has.are_differences) {
    if (has.has_pullback) checks.push_back(&Examination::gradient);
    checks.push_back(&Examination::solution);
    return checks;
  }
  if (has.has_pushforward && has.has_pullback) checks.push_back(&Examination::adjoint);
  // Differences mean little in the single precision of a network: the tests of networks hold each
  // of its derivatives by itself.
  if (!problem.network().is_single_precision()) {
    if (has.has_pushforward) checks.push_back(&Examination::taylor);
    if (has.has_pullback && !has.has_pushforward)
      checks.push_back(&Examination::taylor_of_pullback);
    if (has.has_pullback) checks.push_back(&Examination::gradient);
    checks.insert(checks.end(), {&Examination::jacobian, &Examination::sparse_jacobian,
                                 &Examination::hessian_product});
  }
  checks.push_back(&Examination::rank);
  if (problem.has_identity_network())
    checks.insert(checks.end(), {&Examination::curvature, &Examination::hessian});
  checks.insert(checks.end(),
                {&Examination::inverse, &Examination::damped_inverse, &Examination::solution});
  return checks;
}

// Calls of forward in all checks of a slow problem, and those that its differences make.
Index slow_calls_of(const Problem& problem) {
  const Products has = problem.products();
  Index calls = 3;                   // at the random point, at the start, and at the point again
  if (has.has_pullback) calls += 2;  // the gradient
  constexpr Index kNoiseCalls = 4;   // that the steps of differences follow from
  if (has.are_differences)
    calls += has.has_pullback ? has.pullback_price + kNoiseCalls : 0;
  else if (has.has_pushforward || has.has_pullback)
    calls += kFewSteps.count + 1;
  if (problem.inverse_kind() == Inverse::exact) calls += 2;
  if (problem.minimum() && problem.truth() && problem.has_identity_network()) ++calls;
  return calls;
}

std::vector<Finding> examine_at(const Problem& problem, StartScale scale, RandomStream& stream,
                                const CheckListener& before) {
  if (before) before({0, checks_of(problem, false).size()});
  Examination examination(problem, scale, stream);
  if (!examination.is_finite()) return examination.findings;
  const bool is_slow = examination.is_slow();
  const std::vector<Check> checks = checks_of(problem, is_slow);
  CheckProgress progress{.done = 0, .all = checks.size()};
  if (is_slow) {
    progress.call_seconds = examination.call_seconds();
    progress.calls = slow_calls_of(problem);
  }
  for (std::size_t i = 0; i < checks.size(); ++i) {
    progress.done = i;
    if (before) before(progress);
    examination.make(checks[i]);
  }
  return examination.findings;
}

}  // namespace

// A correct product fails beside a step of 0.01 in an unknown of 1e-4; a wrong one fails with steps
// of every size.
std::vector<Finding> examine(const Problem& problem, RandomStream& stream,
                             const CheckListener& before) {
  std::vector<Finding> findings = examine_at(problem, problem.start_scale(), stream, before);
  const auto all_hold = [](const auto& some) { return std::ranges::all_of(some, &Finding::holds); };
  const Vector sizes = sizes_of_unknowns(problem.start());
  constexpr Real kUnlike = 10;  // less is within what a step of any problem must allow
  const bool is_unlike = sizes.maxCoeff() > kUnlike || sizes.minCoeff() * kUnlike < 1;
  if (!all_hold(findings) && is_unlike && problem.start_scale() != StartScale::own)
    if (std::vector again = examine_at(problem, StartScale::own, stream, before); all_hold(again))
      return again;
  return findings;
}

}  // namespace isoline::problems
