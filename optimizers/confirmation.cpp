// The end of a run: none where evaluations fail; and J confirms that the point at which a method
// stopped by its own test is a solution.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/foreign/line.h"
#include "optimizers/differences.h"
#include "optimizers/examination.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

void InARow::add_outcome(const FailedEvaluations& all) {
  failed = all.total == std::exchange(known, all.total) ? 0 : failed + 1;
  const std::int64_t most =
      all.most_in_a_row > 0 ? all.most_in_a_row : std::max<std::int64_t>(100, 10 * x.size());
  if (failed < most) return;
  const bool is_kept = all.kept > 0 && all.kept == all.total;
  throw CallsFailed(fmt::format("{} evaluations in a row failed{}{}", failed,
                                is_kept ? "; the last: " : "",
                                is_kept ? all.reason[all.kept - 1] : ""));
}

// No run ends at a point whose evaluation failed while it has one with a value.
void Meter::leave_failed_point(Status& verdict) {
  if (std::isfinite(judged_.at.loss) || trace_.failures.total == 0 || !trace_.has_best) return;
  look_at(Eigen::Map<const Vector>(trace_.best, trace_.unknowns));
  if (verdict == Status::diverged || verdict == Status::running) verdict = Status::stalled;
}

bool Meter::knows_jacobian() const {
  return known_.theta.size() == judged_.theta.size() && known_.theta == judged_.theta;
}

const Matrix* Meter::jacobian_at_end() {
  const problems::Products has = problem_.products();
  const bool offers_it = problem_.offers().contains(Oracle::jacobian);
  if (offers_it && !has.are_differences && !known_.is_exact) {
    problem_.jacobian(known_.J, judged_.at);
    known_.theta = judged_.theta;
    known_.by = {};
    known_.is_exact = true;
    return &known_.J;
  }
  if (knows_jacobian()) return &known_.J;
  try {
    if (offers_it) {
      if (!ledger_.pay(Oracle::jacobian, 1)) return nullptr;
      problem_.jacobian(known_.J, judged_.at);
      known_.theta = judged_.theta;
      known_.by.noise = std::max(known_.by.noise, has.noise);
      trace_.difference_noise = has.noise;
      trace_.difference_step = has.step;
      return &known_.J;
    }
    if (!ledger_.has_left(2 * problem_.unknowns() * ledger_.price(Oracle::forward))) return nullptr;
    Linearization at;
    DifferenceJacobian differences;
    const Vector theta = judged_.theta;
    differences.know(sizes_of_unknowns(problem_.standard_start()).cwiseMax(theta.cwiseAbs()),
                     known_.J.size() > 0 ? known_.by.noise : 0);
    linearize(theta, at);
    differences.renew(*this, theta, "central", at);
    return &known_.J;
  } catch (const BudgetSpent&) {
    return nullptr;
  }
}

std::string Meter::doubt() {
  constexpr Index kMostUnknowns = 256, kMostWithoutGradient = 512;
  constexpr Real kSmall = 1e-5;  // of the gradient at the start
  const Real noise = std::max(known_.by.noise, problem_.products().noise);
  const Real loss = judged_.at.loss, largest = judged_.at.y.lpNorm<Eigen::Infinity>();
  const bool is_sum = problem_.is_least_squares();
  const Real rounding = rounding_of_misfit(loss, std::sqrt(2 * loss), largest, noise);
  if (loss > trace_.start_loss + (is_sum ? rounding : 0))
    return "its loss is not below that of the start";
  const Index n = problem_.unknowns();
  const bool is_bounded = problem_.bounds() != nullptr;
  const Real gradient = is_bounded ? trace_.last.kkt_residual : trace_.last.gradient_norm;
  if (!is_sum || n > (std::isnan(gradient) ? kMostWithoutGradient : kMostUnknowns)) {
    if (std::isnan(gradient)) return "its gradient was not examined";
    if (!(gradient > kSmall * start_gradient_)) return "";
    return fmt::format("gradient not small: {:.2g}, {:.2g} at the start", gradient,
                       start_gradient_);
  }
  const bool was_known = knows_jacobian();
  if (!jacobian_at_end()) return "no calls were left to see whether the gradient is small";
  const bool is_by_method =
      !problem_.offers().contains(Oracle::jacobian) || problem_.products().may_be_replaced;
  const Vector r = (judged_.at.y - problem_.target()).reshaped(), slope = known_.J.transpose() * r;
  LeastSquaresPoint at{
      .J = known_.J,
      .residual = r,
      .theta = judged_.theta,
      .sizes = sizes_of_unknowns(problem_.standard_start()),
      .is_held = std::vector<bool>(static_cast<std::size_t>(n)),
      .names = problem_.names(),
      .size_of_y = judged_.at.y.norm(),
      .noise = known_.by.noise,
      .has_exact_jacobian = !is_by_method && !problem_.products().are_differences,
      .is_central = known_.by.is_central,
      .enough_of_deviation = std::max(known_.enough_of_deviation, kEnoughOfDeviation)};
  for (Index i = 0; i < n; ++i) at.is_held[static_cast<std::size_t>(i)] = is_held(i, slope);
  std::string why = doubt_of(at);
  constexpr Real kRounding = 1e-12;  // with what a steep y makes of it
  if (!why.empty() || !is_by_method || known_.by.noise > kRounding) return why;
  at.forgives_noise = false;  // forward differences do not show six digits of a steep y
  why = doubt_of(at);
  if (why.empty() || !was_known || !ledger_.has_left(2 * n)) return why;
  known_.theta.resize(0);
  if (!jacobian_at_end()) return "no calls were left to see whether the gradient is small";
  return doubt_of(at);
}

// A method with a tolerance of its own may end beside a bound.
bool Meter::is_held(Index i, VectorRef slope) const {
  const Bounds* const bounds = problem_.bounds();
  if (bounds == nullptr || bounds->lower[i] == bounds->upper[i]) return bounds != nullptr;
  const Real size = sizes_of_unknowns(problem_.standard_start())[i];
  const Real near = kEnoughOfUnknown * least_size(judged_.theta[i], size);
  Vector theta = judged_.theta;
  if (theta[i] - bounds->lower[i] <= near) theta[i] = bounds->lower[i];
  if (bounds->upper[i] - theta[i] <= near) theta[i] = bounds->upper[i];
  return bounds->is_active(theta, slope, i);
}

}  // namespace isoline::optimizers
