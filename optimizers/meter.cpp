// The meter: counting, budgets, the trace and the verdict on a run.
#include "optimizers/meter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace isoline {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
constexpr Real kNone = -kInfinity;  // a loss that is never reached
constexpr Real kDivergence = 1e12, kStallDecrease = 1e-12;
constexpr std::int64_t kStallIterations = 100;

// Iterations 0 to 100, then 32 a decade.
std::int64_t next_kept_after(std::int64_t iteration) {
  constexpr std::int64_t kEvery = 100;
  constexpr Real kPerDecade = 32;
  if (iteration < kEvery) return iteration + 1;
  const Real passed = std::floor(kPerDecade * std::log10(static_cast<Real>(iteration)) + 1e-9);
  std::int64_t next = iteration;
  for (Real step = passed; next <= iteration; ++step)
    next = std::llround(std::pow(10.0, step / kPerDecade));
  return next;
}

}  // namespace

Meter::Meter(const Problem& problem, const Budget& budget, OracleSet granted, Trace& trace)
    : problem_(problem),
      budget_(budget),
      granted_(granted),
      trace_(trace),
      prices_(problem.prices()),
      best_loss_(kInfinity),
      next_target_(kNone),
      target_loss_(kNone),
      stall_loss_(std::numeric_limits<Real>::max()) {
  trace_.prices = prices_;
  trace_.minimum = problem.minimum().value_or(std::nan(""));
  const bool is_small = problem.inputs() <= Trace::kInputs &&
                        problem.residuals() <= Trace::kOutputs && problem.samples() == 1;
  trace_.path_inputs = is_small ? static_cast<int>(problem.inputs()) : 0;
  trace_.path_outputs = is_small ? static_cast<int>(problem.residuals()) : 0;
}

void Meter::linearize(VectorRef theta, Linearization& at) {
  charge(Oracle::forward);
  at.meter_ = this;
  at.has_jacobian_ = at.has_hessian_ = false;
  problem_.forward(theta, at.point_);
  see(at.point_.loss);
}

Real Meter::loss(VectorRef theta) {
  charge(Oracle::forward);
  problem_.forward(theta, point_);
  see(point_.loss);
  return point_.loss;
}

Real Meter::physics_misfit(BatchRef y, BatchRef x, BatchOut gradient) {
  charge(Oracle::forward);
  charge(Oracle::pullback);
  return problem_.physics_misfit(y, x, point_, gradient);
}

void Meter::refuse(Oracle oracle) const {
  throw std::logic_error(
      fmt::format("the method asked for the oracle '{}', which it does not declare that it needs",
                  name_of(oracle)));
}

void Meter::claim(std::string_view words) { set_text(trace_.claimed, words); }

Status Meter::begin(VectorRef theta) {
  trace_.first_oracle_nanoseconds = monotonic_nanoseconds();
  const double limit = budget_.seconds / seconds_per_tick();  // calibrated off the clock
  if (limit < static_cast<double>(kNoLimit)) most_ticks_ = static_cast<std::uint64_t>(limit);
  previous_ = theta;
  measure(theta);
  trace_.start_loss = judged_.loss;
  trace_.start_x_error = trace_.last.x_error;
  if (problem_.minimum() && std::isfinite(judged_.loss)) {
    target_loss_ = *problem_.minimum() + budget_.target * (judged_.loss - *problem_.minimum());
    next_target_ = kInfinity;
  }
  see(judged_.loss);
  keep_point();
  status_ = judge(theta);
  watch_.resume();
  return status_;
}

Status Meter::iterate(VectorRef theta) {
  ++iteration_;
  if (iteration_ >= next_kept_ || best_loss_ <= target_loss_) {
    watch_.pause();
    measure(theta);
    see(judged_.loss);
    if (iteration_ >= next_kept_) keep_point();
    watch_.resume();
  }
  if (iteration_ + 1 >= next_kept_) previous_ = theta;
  return status_ = judge(theta);
}

void Meter::finish(VectorRef theta, Status verdict) {
  watch_.pause();
  if (trace_.last.iteration != iteration_ || judged_.theta != theta) {
    measure(theta);
    see(judged_.loss);
  }
  trace_.last.counts = counts_;  // a library may have asked much since its last iteration
  trace_.last.work = work_;
  trace_.last.wall_seconds = watch_.seconds();
  trace_.last.processor_seconds = watch_.processor_seconds();
  const int points = trace_.points;  // the curve ends at the returned point
  if (points > 0 && trace_.point[points - 1].iteration == iteration_) trace_.points = points - 1;
  keep_point();
  if (verdict == Status::running) verdict = Status::converged;
  if (judged_.loss <= target_loss_) verdict = Status::target;
  if (!std::isfinite(judged_.loss)) verdict = Status::diverged;
  trace_.status = verdict;
}

// The loss and what surrounds it at θ, by the harness itself, charged to nobody.
void Meter::measure(VectorRef theta) {
  problem_.forward(theta, judged_);
  TracePoint& last = trace_.last;
  last.iteration = iteration_;
  last.counts = counts_;
  last.work = work_;
  last.wall_seconds = watch_.seconds();
  last.processor_seconds = watch_.processor_seconds();
  last.loss = judged_.loss;
  last.x_error = problem_.x_error(judged_.x());
  judged_g_.resize(problem_.outputs(), problem_.samples());
  judged_gradient_.resize(problem_.unknowns());
  problem_.cotangent(judged_, judged_g_);
  problem_.pullback(judged_g_, judged_gradient_, judged_);
  last.gradient_norm = judged_gradient_.norm();
  last.step_norm = (theta - previous_).norm();
}

void Meter::keep_point() {
  const int index = trace_.points;
  if (index >= Trace::kPoints) return;
  trace_.point[index] = trace_.last;
  if (trace_.path_inputs > 0) {
    std::copy_n(judged_.x().data(), judged_.x().size(), trace_.path_x[index]);
    std::copy_n(judged_.y.data(), judged_.y.size(), trace_.path_y[index]);
  }
  trace_.points = index + 1;
  trace_.best_loss = best_loss_;
  next_kept_ = next_kept_after(iteration_);
}

void Meter::reach(Real loss) {
  const Real minimum = problem_.minimum().value_or(kNone);
  while (targets_met_ < Trace::kHits) {
    const Real tau = std::pow(10.0, -targets_met_ / 5.0);
    next_target_ = minimum + tau * (trace_.start_loss - minimum);
    if (!(loss <= next_target_)) return;
    TraceHit& hit = trace_.hit[targets_met_++];
    hit.work = work_;
    hit.forwards = counts_[static_cast<std::size_t>(Oracle::forward)];
    hit.wall_seconds = watch_.seconds();
    hit.iteration = iteration_;
  }
  next_target_ = kNone;
}

bool Meter::has_stalled() {
  if (stall_loss_ - best_loss_ > kStallDecrease * std::abs(stall_loss_)) {
    stall_loss_ = best_loss_;
    stall_iteration_ = iteration_;
  }
  return iteration_ - stall_iteration_ >= kStallIterations;
}

// `judged_` holds the loss at the last kept iteration, which is this one for the first hundred.
Status Meter::judge(VectorRef theta) {
  const Real loss = judged_.loss;
  if (!is_finite(theta) || !std::isfinite(loss) || loss > kDivergence * trace_.start_loss)
    return Status::diverged;
  if (loss <= target_loss_) return Status::target;
  if (has_stalled()) return Status::stalled;
  if (work_ >= budget_.work || iteration_ >= budget_.iterations) return Status::budget;
  if (is_out_of_time()) {
    trace_.stopped_by_clock = true;
    return Status::budget;
  }
  return Status::running;
}

}  // namespace isoline
