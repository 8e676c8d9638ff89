// The scales by which the targets of a run are measured, and its stall.
#include "optimizers/goals.h"

#include <algorithm>

namespace isoline::optimizers {

Goals::Goals(const problems::Problem& problem, const Budget& budget, Trace& trace)
    : trace_(trace),
      most_discrepancy_(budget.discrepancy > 0 && problem.noise_level()
                            ? budget.discrepancy * *problem.noise_level()
                            : kNone) {}

// If the criterion is the error in x, the target of the budget refers to that error.
void Goals::begin(const problems::Problem& problem, const Budget& budget,
                  const problems::Batch& judging) {
  trace_.x_scale = problem.x_scale(judging);
  trace_.x_floor = problem.x_floor(judging);
  const bool has_x_scale = trace_.aim == Aim::x && std::isfinite(trace_.x_scale);
  if (!problem.is_learned() && has_x_scale) next_x_goal_ = kInfinity;
  const bool stops_at_target = budget.target > 0 && most_discrepancy_ == kNone;
  if (has_x_scale && stops_at_target)
    target_x_error_ = x_goal(budget.target, trace_.x_scale, trace_.x_floor);
  if (!problem.minimum()) return;
  const Real descent = trace_.start_loss - trace_.minimum;
  const Real own = problem.loss_scale(judging);
  const Real scale = std::isfinite(own) && own > 0 ? std::min(own, descent) : descent;
  if (std::isnan(descent) || !std::isfinite(scale)) return;
  trace_.scale = std::max(scale, 0.0);
  next_target_ = kInfinity;
  // The minimum of a learned problem is the best loss known, which a longer run may better.
  if (budget.target == 0 && problem.is_learned()) return;
  if (trace_.aim == Aim::loss && most_discrepancy_ == kNone)
    target_loss_ = target_at(budget.target);
}

bool Goals::has_stalled(std::int64_t iteration, std::int64_t most) {
  constexpr Real kStallDecrease = 1e-12;
  if (stall_loss_ - best_loss_ > kStallDecrease * std::abs(stall_loss_)) {
    stall_loss_ = best_loss_;
    stall_iteration_ = iteration;
  }
  return most > 0 && iteration - stall_iteration_ >= most;
}

}  // namespace isoline::optimizers
