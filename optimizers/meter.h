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
#include "optimizers/goals.h"
#include "optimizers/judged.h"
#include "optimizers/ledger.h"
#include "optimizers/linearization.h"
#include "optimizers/observer.h"
#include "optimizers/running.h"

namespace isoline::optimizers {

using problems::Inverse;

using Observers = std::vector<std::unique_ptr<Observer>>;

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
  const Matrix& truth() {                                    // x*, (k, B): extra information
    charge(Oracle::truth);
    return samples_->truth;
  }
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
  Status limit();  // `stalled` or `budget` where the run may go no further, whatever its point
  // By which adapters multiply residuals for libraries with absolute tolerances: a power of 2,
  // about 1/‖r‖ at the start where unknowns are scaled; else 1.
  Real residual_unit() const;
  void reject_step() { ++trace_.rejected_steps; }
  // A method's own J (m·B, n) at θ, by differences.
  void know_jacobian(VectorRef theta, const Matrix& J, const KnownJacobian::Differences& by) {
    known_.theta = theta;
    known_.J = J;
    known_.by = by;
    trace_.difference_noise = by.noise;
    trace_.difference_step = by.step;
  }
  // The share of the standard deviation of each unknown that a step may leave undone, where the
  // user asks for no more.
  void take_as_enough(Real share) { known_.enough_of_deviation = share; }
  // The loss of the last point that the method has paid for. An adapter that keeps it with the
  // point can recall it before the point is judged; another loss changes nothing.
  Real paid_loss() const { return judged_.paid_loss; }
  void recall_paid_loss(Real loss) { judged_.paid_loss = loss; }
  // A library's statement about its own success.
  void claim(std::string_view words) { set_text(trace_.claimed, words); }
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
  void leave_gradients_out() { judged_.has_gradient = false; }  // of what is judged
  const Problem& problem() const { return problem_; }
  const Vector& judged() const { return judged_.theta; }  // (n), the last θ that was looked at
  const Point& judged_point() const { return judged_.at; }
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
  Vector& origin() { return in_a_row_.origin; }

 private:
  friend class Linearization;
  void charge(Oracle oracle) {
    if (!granted_.contains(oracle)) refuse(oracle);
    ledger_.charge(oracle, Problem::is_solve(oracle) ? solve_iterations_ : 1);
  }
  [[noreturn]] void refuse(Oracle oracle) const;
  void charge_forward(VectorRef theta);
  void disturb(Point& at);
  bool look_at(VectorRef theta);
  std::string doubt();  // why the returned point is not confirmed as a solution; empty where it is
  bool pay_for_judged();
  bool is_out_of_work() const {
    return ledger_.is_spent(solve_iterations_ * ledger_.price(Oracle::forward));
  }
  // A learning problem is judged by its validation samples, not by the batch of a step.
  void see(const Point& at, VectorRef theta) {
    if (problem_.is_learned()) return;
    judged_.paid_loss = at.loss;
    observe(at.loss, theta);
    if (goals_.wants_x_errors()) observe_x(problem_.x_error(at.x(), *samples_));
  }
  void observe_x(Real error) {
    goals_.meet_x(error, [this](TraceHit& hit) { note(hit); });
  }
  void observe(Real loss, VectorRef theta) {
    if (goals_.improves(loss)) keep_best(theta);
    goals_.meet(loss, [this](TraceHit& hit) { note(hit); });
  }
  void keep_best(VectorRef theta) {
    if (trace_.unknowns == 0 || theta.size() != trace_.unknowns) return;
    std::copy_n(theta.data(), trace_.unknowns, trace_.best);
    trace_.has_best = true;
  }
  void note(TraceHit& hit) const;
  void measure(VectorRef theta);  // fills trace_.last, off the clock
  void measure_series();          // of the problem, at the point that was judged last
  void keep_point();
  void prepare();  // samples and limits
  void draw_batch();
  void refine(VectorRef theta);
  void note_batch(const Point& at);
  Status judge(VectorRef theta);
  void leave_failed_point(Status& verdict);
  bool is_out_of_time() const { return most_ticks_ != kNoLimit && watch_.elapsed() >= most_ticks_; }
  static constexpr auto kNoLimit = std::numeric_limits<std::uint64_t>::max();

  const Problem& problem_;
  Budget budget_;
  OracleSet granted_;
  Trace& trace_;
  Observers observers_;
  const Batch* samples_;  // of this step
  Batch batch_, validation_;
  BatchMeans means_;
  Ledger ledger_;
  Goals goals_;
  InARow in_a_row_;
  std::uint64_t disturbed_ = 0;  // calls
  std::int64_t iteration_ = 0, next_kept_ = 0;
  Stopwatch watch_;
  std::uint64_t most_ticks_ = kNoLimit;  // budget_.seconds on the stopwatch
  Status status_ = Status::running;
  Point point_;  // for Meter::loss
  Judged judged_;
  Vector previous_;  // (n)
  KnownJacobian known_;
  Real start_gradient_ = 0;              // ‖∇L‖
  problems::Refinement::State refined_;  // of a problem that has such
  std::int64_t solve_iterations_;        // as so many calls a solve of this step counts
};

}  // namespace isoline::optimizers
