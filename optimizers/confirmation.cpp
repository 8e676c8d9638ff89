// Confirms by J that the point at which a method stopped by its own test is a solution.
#include <fmt/format.h>

#include <algorithm>

#include "optimizers/differences.h"
#include "optimizers/examination.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

bool Meter::knows_jacobian() const {
  return known_theta_.size() == judged_theta_.size() && known_theta_ == judged_theta_;
}

const Matrix* Meter::jacobian_at_end() {
  const problems::Products has = problem_.products();
  const bool offers_it = problem_.offers().contains(Oracle::jacobian);
  if (offers_it && !has.are_differences && !knows_exact_) {
    problem_.jacobian(known_J_, judged_);
    known_theta_ = judged_theta_;
    known_by_ = {};
    knows_exact_ = true;
    return &known_J_;
  }
  if (knows_jacobian()) return &known_J_;
  try {
    const std::int64_t price =
        prices_[static_cast<std::size_t>(offers_it ? Oracle::jacobian : Oracle::forward)];
    const std::int64_t calls = offers_it ? 1 : 2 * problem_.unknowns();
    if (work_ + calls * price > budget_.work) return nullptr;
    if (offers_it) {
      problem_.jacobian(known_J_, judged_);
      counts_[static_cast<std::size_t>(Oracle::jacobian)] += calls;
      work_ += calls * price;
      known_theta_ = judged_theta_;
      known_by_.noise = std::max(known_by_.noise, has.noise);
      trace_.difference_noise = has.noise;
      trace_.difference_step = has.step;
      return &known_J_;
    }
    Linearization at;
    DifferenceJacobian differences;
    const Vector theta = judged_theta_;
    if (known_J_.size() > 0) differences.know_noise(theta, known_by_.noise);
    linearize(theta, at);
    differences.renew(*this, theta, "central", at);
    return &known_J_;
  } catch (const BudgetSpent&) {
    return nullptr;
  }
}

std::string Meter::doubt() {
  constexpr Index kMostUnknowns = 256;
  constexpr Real kSmall = 1e-5;  // of the gradient at the start
  if (judged_.loss > trace_.start_loss) return "its loss is not below that of the start";
  const Index n = problem_.unknowns();
  if (!problem_.is_least_squares() || n > kMostUnknowns) {
    const bool is_bounded = problem_.bounds() != nullptr;
    const Real slope = is_bounded ? trace_.last.kkt_residual : trace_.last.gradient_norm;
    if (!(slope > kSmall * start_gradient_)) return "";
    return fmt::format("gradient not small: {:.2g}, {:.2g} at the start", slope, start_gradient_);
  }
  const bool was_known = knows_jacobian();
  if (!jacobian_at_end()) return "no calls were left to see whether the gradient is small";
  const bool is_by_method = !problem_.offers().contains(Oracle::jacobian);
  const Vector r = (judged_.y - problem_.target()).reshaped(), slope = known_J_.transpose() * r;
  LeastSquaresPoint at{.J = known_J_,
                       .residual = r,
                       .theta = judged_theta_,
                       .sizes = sizes_of_unknowns(problem_.standard_start()),
                       .is_held = std::vector<bool>(static_cast<std::size_t>(n)),
                       .names = problem_.names(),
                       .size_of_y = judged_.y.norm(),
                       .noise = known_by_.noise,
                       .has_exact_jacobian = !is_by_method && !problem_.products().are_differences,
                       .is_central = known_by_.is_central,
                       .enough_of_deviation = std::max(enough_of_deviation_, kEnoughOfDeviation)};
  for (Index i = 0; i < n; ++i) at.is_held[static_cast<std::size_t>(i)] = is_held(i, slope);
  std::string why = doubt_of(at);
  constexpr Real kRounding = 1e-12;  // with what a steep y makes of it
  if (!why.empty() || !is_by_method || known_by_.noise > kRounding) return why;
  at.forgives_noise = false;  // forward differences do not show six digits of a steep y
  why = doubt_of(at);
  if (why.empty() || !was_known || work_ + 2 * n > budget_.work) return why;
  known_theta_.resize(0);
  if (!jacobian_at_end()) return "no calls were left to see whether the gradient is small";
  return doubt_of(at);
}

bool Meter::is_held(Index i, VectorRef slope) const {
  const Bounds* const bounds = problem_.bounds();
  return bounds != nullptr &&
         (bounds->is_active(judged_theta_, slope, i) || bounds->lower[i] == bounds->upper[i]);
}

}  // namespace isoline::optimizers
