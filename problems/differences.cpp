// P without derivatives, or with differences whose steps follow from the noise of its values.
#include "problems/differences.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/differences.h"
#include "core/errors.h"
#include "core/workspace.h"
#include "problems/model.h"
#include "problems/wrapper.h"

namespace isoline::problems {
namespace {

// The workspace of P at x, and y there.
struct Inside final : Scratch {
  Workspace w, moved;
  Matrix y;  // (m, B)
};

class Differenced final : public Wrapper {
 public:
  // `start`: where the noise is measured, once, before the first product.
  Differenced(std::unique_ptr<Physics> inside, const std::string& derivatives, std::string steps,
              Vector start, std::optional<Bounds> bounds, Vector factors)
      : inside_(std::move(inside)),
        is_central_(derivatives == "central"),
        has_products_(derivatives != "none"),
        steps_(std::move(steps)),
        given_(given_steps(steps_)),
        start_(std::move(start)),
        sizes_(sizes_of_unknowns(start_)),
        bounds_(std::move(bounds)),
        factors_(std::move(factors)) {}
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
            .may_be_replaced = has_products_ && has_inverse_ && given_.steps.empty(),
            .are_at_once = has_products_,
            .noise = noise_,
            .step = given_.steps.empty() && noise_ > 0 ? step() : std::nan("")};
  }
  const std::string& steps() const { return steps_; }
  void keep_inverse() { has_inverse_ = true; }  // of a script that leaves its derivatives to us
  const Physics& inside() const override { return *inside_; }
  std::unique_ptr<Physics> take_inside() { return std::move(inside_); }
  Inverse inverse_kind() const override {
    return has_inverse_ ? inside_->inverse_kind() : Inverse::none;
  }
  Index inverse_price() const override { return inside_->inverse_price(); }
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const override {
    return inside_->local_inverse(y, x0, c, x);
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
    Room room;
    const std::array<Real, 2> at = offsets_along(own, v, room);
    Jv = quotient_of_calls(at, room, own.y, [&](Real t) { return value(own, own.w.x + t * v); });
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
  Real step() const { return is_central_ ? central_step(noise_) : forward_step(noise_); }
  // Inside the bounds, for all samples.
  std::array<Real, 2> offsets_along(const Inside& own, BatchRef v, Room& room) const {
    measure_noise(own);
    const Matrix& x = own.w.x;
    const Vector sizes = x.rowwise().lpNorm<Eigen::Infinity>().cwiseMax(sizes_);
    Vector steps = sizes;
    for (Index i = 0; i < steps.size() && !given_.steps.empty(); ++i)
      steps[i] = given_step(given_, *inside_, x.col(0), i, sizes[i], 0);
    const Real length = (v.array().colwise() / steps.array()).abs().maxCoeff();
    const Real step = given_.steps.empty() ? this->step() : 1;
    for (Index b = 0; bounds_ && b < x.cols(); ++b)
      for (Index i = 0; i < x.rows(); ++i) {
        if (v(i, b) == 0) continue;
        const Real to_upper = (bounds_->upper[i] - x(i, b)) / std::abs(v(i, b));
        const Real to_lower = (x(i, b) - bounds_->lower[i]) / std::abs(v(i, b));
        room.up = std::min(room.up, v(i, b) > 0 ? to_upper : to_lower);
        room.down = std::min(room.down, v(i, b) > 0 ? to_lower : to_upper);
      }
    return difference_offsets(step / (length > 0 ? length : 1), is_central_, room.up, room.down);
  }
  // All forwards of J, in the order in which jacobian() asks for them.
  void begin_differences(const Inside& own) const {
    const Index k = inputs();
    Matrix points(k, 2 * k);
    Index calls = 0;
    for (Index i = 0; i < k; ++i) {
      const Matrix v = Matrix::Identity(k, k).col(i);
      Room room;
      for (const Real h : offsets_along(own, v, room))
        if (h != 0) points.col(calls++) = own.w.x + h * v;
    }
    inside_->begin_forwards(points.leftCols(calls));
  }
  Matrix value(Inside& own, const Matrix& x) const {
    Matrix y(outputs(), x.cols());
    own.moved.x = x;
    own.moved.context = own.w.context;
    own.moved.saved_is_current = false;
    inside_->forward(own.moved.x, own.w.context, y, own.moved);
    disturb(own.moved.x, y);
    return y;
  }
  void measure_noise(const Inside& own) const {
    if (noise_ > 0) return;
    Inside other;
    other.w.context = own.w.context;
    const Index batch = own.w.x.cols();
    const Vector line = line_inside(start_, sizes_, bounds_ ? &bounds_->lower : nullptr,
                                    bounds_ ? &bounds_->upper : nullptr);
    const auto y = [&](Real t) -> Vector {
      return value(other, (start_ + t * line).replicate(1, batch)).reshaped();
    };
    noise_ =
        noise_of_calls(y(0), y, batch == 1 ? factors_ : Vector(Vector::Ones(batch * outputs())));
  }
  // The number of the call is a digest of x: products have no state.
  void disturb(BatchRef x, BatchOut y) const {
    if (!jitter_) return;
    PieceDigest call;
    for (const Real value : x.reshaped()) call.add(std::bit_cast<std::uint64_t>(value));
    jitter_->disturb(call.value(), target_, y);
  }

  std::unique_ptr<Physics> inside_;
  bool is_central_, has_products_, has_inverse_ = false;
  std::string steps_;  // as the user gave them
  GivenSteps given_;
  Vector start_, sizes_;  // (k)
  std::optional<Bounds> bounds_;
  Vector factors_;          // of y, (m), without penalties
  mutable Real noise_ = 0;  // 0: not yet measured
  std::optional<Jitter> jitter_;
  Matrix target_;  // (m, B)
};

}  // namespace

Real relative_noise(const Problem& problem, const Vector& x) {
  const Bounds* const bounds = problem.bounds();
  const Vector line = line_inside(x, sizes_of_unknowns(x), bounds ? &bounds->lower : nullptr,
                                  bounds ? &bounds->upper : nullptr);
  Point at;
  std::uint64_t call = 0;
  const auto y = [&](Real t) -> Vector {
    problem.forward(x + t * line, at);
    if (const Jitter* jitter = problem.jitter()) jitter->disturb(call++, problem.target(), at.y);
    return at.y.reshaped();
  };
  const Vector y0 = y(0);
  if (!is_finite(y0)) return std::numeric_limits<Real>::quiet_NaN();
  return noise_of_calls(y0, y, problem.factors_of_data());
}

void replace_derivatives(ProblemParts& parts, const std::string& derivatives, bool keeps_inverse,
                         const std::string& steps) {
  Vector factors = factors_of_data(*parts.physics, parts.physics->outputs() - parts.penalties);
  auto physics =
      std::make_unique<Differenced>(std::move(parts.physics), derivatives, steps,
                                    parts.start.standard, parts.bounds, std::move(factors));
  if (parts.jitter) physics->set_jitter(*parts.jitter, parts.target);
  if (keeps_inverse) physics->keep_inverse();
  parts.physics = std::move(physics);
}

std::optional<std::string> remove_differences(ProblemParts& parts) {
  auto* const differenced = dynamic_cast<Differenced*>(parts.physics.get());
  if (differenced == nullptr) return std::nullopt;
  std::string steps = differenced->steps();
  parts.physics = differenced->take_inside();
  return steps;
}

}  // namespace isoline::problems
