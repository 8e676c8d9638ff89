// The only access of an optimizer to a problem. It counts every oracle by kind, refuses those that
// the method did not declare, times, budgets and traces. Optimizers never log and never evaluate
// success.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "core/archive.h"
#include "core/array.h"
#include "core/clock.h"
#include "core/failures.h"
#include "core/status.h"
#include "core/trace.h"
#include "optimizers/linearization.h"
#include "optimizers/observer.h"
#include "optimizers/running.h"

namespace isoline::optimizers {

using problems::Inverse;

using Observers = std::vector<std::unique_ptr<Observer>>;

// An oracle throws it if its call would exceed the budget of work: the step is not taken, and the
// run ends with the status `budget`. No library may let it pass.
struct BudgetSpent {};

class Meter {
 public:
  // `granted`: what the method declared that it needs. `trace` outlives the meter.
  Meter(const Problem& problem, const Budget& budget, OracleSet granted, Trace& trace,
        Observers observers = {});

  // --- for methods
  void linearize(VectorRef theta, Linearization& at);
  Real loss(VectorRef theta);
  void linearize_physics(BatchRef x, Linearization& at);  // at an x, the network left out
  // The next calls of linearize() or loss() are at these columns (n, count), in their order: a
  // problem with several workers computes them at once, and they share rounds. Nothing else
  // changes.
  void announce(const Matrix& thetas);
  // The samples of this step: the same for every call within it.
  const Matrix& target() const { return samples_->target; }  // y*, (m, B)
  const Matrix& truth();                                     // x*, (k, B): extra information
  std::vector<Block> layout() const { return problem_.layout(); }
  const SparsePattern* sparse_pattern() const { return problem_.sparse_pattern(); }
  // Whether J comes as the values of its pattern alone. An audit grants a dense J, too, which
  // serves any problem.
  bool is_sparse() const {
    return is_granted(Oracle::sparse_jacobian) && !is_granted(Oracle::jacobian);
  }
  const Bounds* bounds() const { return problem_.bounds(); }  // nullptr: none
  Index unknowns() const { return problem_.unknowns(); }
  Index residuals() const { return problem_.residuals(); }
  Index samples() const { return problem_.samples(); }
  bool has_identity_network() const { return problem_.has_identity_network(); }
  Inverse inverse_kind() const { return problem_.inverse_kind(); }
  bool has_fresh_batches() const { return problem_.has_fresh_batches(); }
  bool is_granted(Oracle oracle) const { return granted_.contains(oracle); }

  // The solver of a library reports each iteration here, and stops unless the answer is `running`.
  Status iterate(VectorRef theta);
  // Whether the budget of work or time is spent, for inner loops and callbacks of libraries. The
  // loop of the harness checks this itself.
  bool is_spent() const {
    return is_out_of_work() || iteration_ >= budget_.iterations || is_out_of_time();
  }
  Status status() const { return status_; }
  // By which adapters multiply residuals for libraries with absolute tolerances: a power of 2,
  // about 1/‖r‖ at the start where unknowns are scaled; else 1.
  Real residual_unit() const;
  void reject_step() { ++trace_.rejected_steps; }
  // A method's own J (m·B, n) at θ, by differences.
  struct Differences {
    Real noise = std::numeric_limits<Real>::epsilon();  // of y in a call, relative to ‖y‖
    Real step = 0;  // relative to the sizes of the unknowns; NaN where the user gave others
    bool is_central = false;
  };
  void know_jacobian(VectorRef theta, const Matrix& J, const Differences& by) {
    known_theta_ = theta;
    known_J_ = J;
    known_by_ = by;
    trace_.difference_noise = by.noise;
    trace_.difference_step = by.step;
  }
  // The share of the standard deviation of each unknown that a step may leave undone, where the
  // user asks for no more.
  void take_as_enough(Real share) { enough_of_deviation_ = share; }
  // The loss of the last point that the method has paid for. An adapter that keeps it with the
  // point can recall it before the point is judged; another loss changes nothing.
  Real paid_loss() const { return paid_loss_; }
  void recall_paid_loss(Real loss) { paid_loss_ = loss; }
  void claim(std::string_view words);  // a library's statement about its own success
  // Quantities of the method, which the trace stores at the same iterations as those of the
  // problem. A method names them once, at its start, and reports them each time they change.
  void name_series(const std::vector<std::string>& names);
  void note(std::size_t which, Real value);

  // --- for the harness
  Status begin(VectorRef theta);
  // The complete state of a run, from which another process can continue. Reading it starts the
  // run.
  void persist(Archive& archive);
  // Returns the final θ of the run: this one, or the last verified one if the budget does not have
  // a forward solve left for this one.
  Vector finish(VectorRef theta, Status verdict);
  void leave_gradients_out() { measures_gradients_ = false; }  // of what is judged
  const Problem& problem() const { return problem_; }
  const Vector& judged() const { return judged_theta_; }  // (n), the last θ that was looked at
  const Point& judged_point() const { return judged_; }
  std::int64_t iteration() const { return iteration_; }
  const Batch& samples_of_step() const { return *samples_; }
  const Batch& judging() const { return problem_.is_learned() ? validation_ : problem_.batch(); }
  // J at the returned point: the exact one of the problem, that of the method, or by central
  // differences, which count as calls of the run do. nullptr where the budget has none left.
  const Matrix* jacobian_at_end();               // (m·B, n)
  bool knows_jacobian() const;                   // of the point that was judged, by the method
  bool is_held(Index i, VectorRef slope) const;  // by its bounds, at that point
  const Trace& trace() const { return trace_; }
  void remark(std::string_view sentence);  // becomes the message of the run if it has none
  const FailedEvaluations& failures() const { return trace_.failures; }
  // (n), where the last step began in which no evaluation failed; a part of the state of the run.
  Vector& origin() { return origin_; }

 private:
  friend class Linearization;
  void charge(Oracle oracle) {
    const auto kind = static_cast<std::size_t>(oracle);
    if (!granted_.contains(oracle)) refuse(oracle);
    const std::int64_t calls = Problem::is_solve(oracle) ? solve_iterations_ : 1;
    if (work_ + calls * prices_[kind] > most_work_) exhaust();
    counts_[kind] += calls;
    work_ += calls * prices_[kind];
  }
  [[noreturn]] void refuse(Oracle oracle) const;
  [[noreturn]] void exhaust();
  void charge_forward(VectorRef theta);
  void count_into(TracePoint& point) const;
  Rounds rounds() const;
  void share_rounds(std::int64_t calls);
  void disturb(Point& at);
  bool look_at(VectorRef theta);
  std::string doubt();  // why the returned point is not confirmed as a solution; empty where it is
  bool pay_for_judged();
  bool is_out_of_work() const {
    const std::int64_t price = prices_[static_cast<std::size_t>(Oracle::forward)];
    return is_exhausted_ || work_ + solve_iterations_ * price > most_work_;
  }
  // A learning problem is judged by its validation samples, not by the batch of a step.
  void see(const Point& at, VectorRef theta) {
    if (problem_.is_learned()) return;
    paid_loss_ = at.loss;
    observe(at.loss, theta);
    if (next_x_goal_ >= 0) observe_x(problem_.x_error(at.x(), *samples_));
  }
  void observe_x(Real error) {
    if (error <= next_x_goal_) reach_x(error);
  }
  void observe(Real loss, VectorRef theta) {
    if (loss < best_loss_) {
      best_loss_ = loss;
      keep_best(theta);
    }
    if (loss <= next_target_) reach(loss);
  }
  void keep_best(VectorRef theta) {
    if (trace_.unknowns == 0 || theta.size() != trace_.unknowns) return;
    std::copy_n(theta.data(), trace_.unknowns, trace_.best);
    trace_.has_best = true;
  }
  void reach(Real loss);     // records the targets that `loss` meets
  void reach_x(Real error);  // and those that this error in x meets
  void note(TraceHit& hit) const;
  void measure(VectorRef theta);  // fills trace_.last, off the clock
  void measure_series();          // of the problem, at the point that was judged last
  void keep_point();
  void prepare();     // samples and limits
  void set_scales();  // by which this run's targets are measured; after the start's loss
  Real target_at(Real tau) const { return trace_.minimum + tau * trace_.scale; }  // nan where none
  void draw_batch();
  void refine(VectorRef theta);
  void note_batch(const Point& at);
  Status judge(VectorRef theta);
  void leave_failed_point(Status& verdict);
  bool has_stalled();
  // By the last point that was judged.
  bool is_target_met() const {
    return judged_.loss <= target_loss_ || trace_.last.x_error <= target_x_error_;
  }
  // The discrepancy principle, by the last point that was judged.
  bool is_at_noise() const { return trace_.last.discrepancy <= most_discrepancy_; }
  bool is_out_of_time() const { return most_ticks_ != kNoLimit && watch_.elapsed() >= most_ticks_; }
  static constexpr auto kNoLimit = std::numeric_limits<std::uint64_t>::max();

  const Problem& problem_;
  Budget budget_;
  OracleSet granted_;
  Trace& trace_;
  Observers observers_;
  const Batch* samples_;  // of this step
  Batch batch_, validation_;
  RunningMean batch_loss_, batch_x_error_;
  bool has_seen_batch_ = false;  // whether this step's batch is among the means
  OracleCounts counts_{};
  OracleCounts prices_;
  std::int64_t work_ = 0, iteration_ = 0, next_kept_ = 0;
  std::uint64_t disturbed_ = 0;  // calls
  InARow in_a_row_;
  Vector origin_;                 // (n)
  Rounds spared_{};               // work less rounds
  Matrix announced_;              // (n, count)
  Index next_announced_ = 0;      // column
  std::int64_t in_batch_ = 0;     // calls of the announced ones that were charged
  bool are_products_at_once_;     // of the problem: by forwards that share rounds
  Real best_loss_, next_target_;  // the loss that meets the next of the 51 targets
  Real target_loss_;
  Real next_x_goal_;  // the error in x that meets the next of the 51 targets
  int targets_met_ = 0, x_targets_met_ = 0;
  Real stall_loss_;
  std::int64_t stall_iteration_ = 0;
  Stopwatch watch_;
  std::uint64_t most_ticks_ = kNoLimit;  // budget_.seconds on the stopwatch
  Status status_ = Status::running;
  Point point_;   // for Meter::loss
  Point judged_;  // for the harness's own evaluations, and their ∂L/∂y (m, B) and ∇L (n)
  Matrix judged_g_;
  Vector judged_gradient_, judged_theta_, previous_;
  Real target_x_error_;    // −∞: the loss decides
  Real most_discrepancy_;  // τδ; −∞: no such rule
  // One forward of the budget is left for the returned point.
  std::int64_t most_work_;
  bool is_exhausted_ = false;  // an oracle would have exceeded the budget
  Real paid_loss_;             // of the last point that the method has paid for
  bool is_prepaid_ = false;    // a forward at judged_theta_
  Vector accepted_;            // (n), the last θ that was judged and is paid for
  bool measures_gradients_ = true;
  Vector known_theta_;        // (n)
  Matrix known_J_;            // (m·B, n) there
  bool knows_exact_ = false;  // known_J_ is the problem's own, at the returned point
  Differences known_by_;      // of that J
  Real enough_of_deviation_ = 0;
  Real start_gradient_ = 0;                 // ‖∇L‖
  const problems::Refinement* refinement_;  // nullptr: none
  problems::Refinement::State refined_;
  std::int64_t solve_iterations_;  // as so many calls a solve of this step counts
  Point watched_;                  // of the validation, to refine by
};

}  // namespace isoline::optimizers
