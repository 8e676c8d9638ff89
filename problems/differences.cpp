// P without derivatives, or with differences whose steps follow from the noise of its values.
#include "problems/differences.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/differences.h"
#include "core/errors.h"
#include "core/workspace.h"

namespace isoline::problems {
namespace {

constexpr Real kRounding = std::numeric_limits<Real>::epsilon();

// The workspace of P at x, and y there.
struct Inside final : Scratch {
  Workspace w, moved;
  Matrix y;  // (m, B)
};

class Differenced final : public Physics {
 public:
  Differenced(std::unique_ptr<Physics> inside, const std::string& derivatives)
      : inside_(std::move(inside)),
        is_central_(derivatives == "central"),
        has_products_(derivatives != "none") {}
  void set_steps(Real noise, Vector sizes) {
    step_ = is_central_ ? central_step(noise) : forward_step(noise);
    sizes_ = std::move(sizes);
  }
  void set_jitter(const Jitter& jitter, const Matrix& target) {
    jitter_ = jitter;
    target_ = target;
  }

  Index inputs() const override { return inside_->inputs(); }
  Index outputs() const override { return inside_->outputs(); }
  bool is_elsewhere() const override { return inside_->is_elsewhere(); }
  Products products() const override {
    const Index calls = is_central_ ? 2 : 1;
    return {.has_pushforward = has_products_,
            .has_pullback = has_products_,
            .pushforward_price = calls,
            .pullback_price = calls * inputs(),
            .are_differences = has_products_,
            .are_at_once = has_products_};
  }

  void begin_forwards(BatchRef x) const override { inside_->begin_forwards(x); }
  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const override {
    Inside& own = w.as<Inside>();
    own.w.x = x;
    own.w.context = c;
    own.w.saved_is_current = false;
    inside_->forward(own.w.x, c, y, own.w);
    own.y = y;
    disturb(own.w.x, own.y);
  }
  // Along v by a step relative to the size of each unknown.
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Inside& own = w.as<Inside>();
    const Real h = step_along(own, v);
    Jv = moved(own, v, h);
    if (is_central_)
      Jv = (Jv - moved(own, v, -h)) / (2 * h);
    else
      Jv = (Jv - own.y) / h;
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    const Index k = inputs(), batch = u.cols();
    Matrix J(outputs(), k * batch);
    jacobian(J, w);
    for (Index b = 0; b < batch; ++b) JTu.col(b) = J.middleCols(b * k, k).transpose() * u.col(b);
  }
  void jacobian(BatchOut J, Workspace& w) const override {
    const Index k = inputs(), batch = J.cols() / k;
    Matrix v, Jv(outputs(), batch);
    if (batch == 1) begin_differences(w.as<Inside>());
    for (Index i = 0; i < k; ++i) {
      v.setZero(k, batch);
      v.row(i).setOnes();
      pushforward(v, Jv, w);
      for (Index b = 0; b < batch; ++b) J.col(b * k + i) = Jv.col(b);
    }
  }

 private:
  Real step_along(const Inside& own, BatchRef v) const {
    const Vector sizes = own.w.x.rowwise().lpNorm<Eigen::Infinity>().cwiseMax(sizes_);
    const Real length = (v.array().colwise() / sizes.array()).abs().maxCoeff();
    return step_ / (length > 0 ? length : 1);
  }
  // All forwards of J, in the order in which jacobian() asks for them.
  void begin_differences(const Inside& own) const {
    const Index k = inputs(), calls = is_central_ ? 2 : 1;
    Matrix points(k, calls * k);
    for (Index i = 0; i < k; ++i) {
      const Matrix v = Matrix::Identity(k, k).col(i);
      const Real h = step_along(own, v);
      points.col(calls * i) = own.w.x + h * v;
      if (is_central_) points.col(calls * i + 1) = own.w.x - h * v;
    }
    inside_->begin_forwards(points);
  }
  // P(x + h v)
  Matrix moved(Inside& own, BatchRef v, Real h) const {
    Matrix y(outputs(), v.cols());
    own.moved.x = own.w.x + h * v;
    own.moved.context = own.w.context;
    own.moved.saved_is_current = false;
    inside_->forward(own.moved.x, own.w.context, y, own.moved);
    disturb(own.moved.x, y);
    return y;
  }
  // The number of the call is a digest of x: products have no state.
  void disturb(BatchRef x, BatchOut y) const {
    if (!jitter_) return;
    PieceDigest call;
    for (const Real value : x.reshaped()) call.add(std::bit_cast<std::uint64_t>(value));
    jitter_->disturb(call.value(), target_, y);
  }

  std::unique_ptr<Physics> inside_;
  bool is_central_, has_products_;
  Real step_ = 0;
  Vector sizes_;  // (k)
  std::optional<Jitter> jitter_;
  Matrix target_;  // (m, B)
};

}  // namespace

Real relative_noise(const Problem& problem, const Vector& x) {
  RandomStream stream(0, "", "noise of values");
  const Vector direction =
      sizes_of_unknowns(x).cwiseProduct(stream.uniform_vector(x.size(), -1, 1));
  Point at;
  std::uint64_t call = 0;
  const auto value = [&](Real t) -> Vector {
    problem.forward(x + t * direction, at);
    if (const Jitter* jitter = problem.jitter()) jitter->disturb(call++, problem.target(), at.y);
    return at.y.reshaped();
  };
  const Real size = value(0).lpNorm<Eigen::Infinity>();
  const Vector noise = noise_of_values(value);
  const Real relative = noise.norm() / std::sqrt(static_cast<Real>(noise.size())) / size;
  return std::isfinite(relative) ? std::max(kRounding, relative) : kRounding;
}

void replace_derivatives(ProblemParts& parts, const std::string& derivatives) {
  Real noise = 0;
  const Vector start = parts.start.standard;
  if (derivatives != "none") {
    Problem plain(std::move(parts));
    noise = relative_noise(plain, start);
    parts = std::move(plain).parts();
  }
  auto physics = std::make_unique<Differenced>(std::move(parts.physics), derivatives);
  physics->set_steps(noise, sizes_of_unknowns(start));
  if (parts.jitter) physics->set_jitter(*parts.jitter, parts.target);
  parts.physics = std::move(physics);
}

}  // namespace isoline::problems
