// The goals of a run, and how far it has come: the targets of its loss and of its error in x, that
// of its budget, the noise of its data; and whether it still makes progress.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/archive.h"
#include "core/trace.h"
#include "problems/problem.h"

namespace isoline::optimizers {

class Goals {
 public:
  Goals(const problems::Problem& problem, const Budget& budget, Trace& trace);

  // s = min(f₀ − f_L, the problem's scale), and the scale of errors in x: from now on, which is
  // after the loss of the start is known, points are compared with targets.
  void begin(const problems::Problem& problem, const Budget& budget,
             const problems::Batch& judging);

  Real best_loss() const { return best_loss_; }
  bool improves(Real loss) { return loss < best_loss_ && (best_loss_ = loss, true); }
  // Calls note(hit) for each target that is met for the first time.
  void meet(Real loss, auto&& note) {
    if (!(loss <= next_target_) || !std::isfinite(loss)) return;
    trace_.best_loss = best_loss_;  // a run that is killed before its next kept point has met it
    while (targets_met_ < kRungs) {
      next_target_ = target_at(rung(static_cast<std::size_t>(targets_met_)));
      if (!(loss <= next_target_)) return;
      note(trace_.hit[targets_met_++]);
    }
    next_target_ = kNone;
  }
  bool wants_x_errors() const { return next_x_goal_ >= 0; }
  void meet_x(Real error, auto&& note) {
    if (!(error <= next_x_goal_)) return;
    while (x_targets_met_ < kRungs) {
      next_x_goal_ =
          x_goal(rung(static_cast<std::size_t>(x_targets_met_)), trace_.x_scale, trace_.x_floor);
      if (!(error <= next_x_goal_)) return;
      note(trace_.x_hit[x_targets_met_++]);
    }
    next_x_goal_ = kNone;
  }
  // Whether an evaluated point may end the run, so that each iterate is to be judged. The
  // discrepancy principle requires each.
  bool wants_each_iterate() const {
    return best_loss_ <= target_loss_ || most_discrepancy_ > kNone;
  }
  bool is_target_met(Real loss, Real x_error) const {
    return loss <= target_loss_ || x_error <= target_x_error_;
  }
  bool is_at_noise(Real discrepancy) const { return discrepancy <= most_discrepancy_; }
  // After an iteration: whether the best loss has not fallen for `most` of them; 0: any number.
  bool has_stalled(std::int64_t iteration, std::int64_t most);

  void persist(Archive& archive) {
    archive(best_loss_, next_target_, target_loss_, target_x_error_, targets_met_, next_x_goal_,
            x_targets_met_, stall_loss_, stall_iteration_);
  }
  bool is_sound() const {  // what a file brought back need not be
    return targets_met_ >= 0 && targets_met_ <= kRungs && x_targets_met_ >= 0 &&
           x_targets_met_ <= kRungs;
  }

 private:
  static constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  static constexpr Real kNone = -kInfinity;  // what is never reached
  Real target_at(Real tau) const { return trace_.minimum + tau * trace_.scale; }  // nan where none

  Trace& trace_;
  Real best_loss_ = kInfinity;
  Real next_target_ = kNone, next_x_goal_ = kNone;  // that meet the next of the 51 targets
  Real target_loss_ = kNone, target_x_error_ = kNone;
  Real most_discrepancy_;  // τδ; −∞: no such rule
  int targets_met_ = 0, x_targets_met_ = 0;
  Real stall_loss_ = std::numeric_limits<Real>::max();
  std::int64_t stall_iteration_ = 0;
};

}  // namespace isoline::optimizers
