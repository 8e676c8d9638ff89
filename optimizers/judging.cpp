// The meter as the harness has it: a run begun, traced, judged and ended.
#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

using problems::Series;
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
constexpr Real kDivergence = 1e12, kStallDecrease = 1e-12;
constexpr std::int64_t kStallIterations = 100;

}  // namespace

Status Meter::begin(VectorRef theta) {
  prepare();
  open_pictures();
  previous_ = theta;
  measure(theta);
  trace_.start_loss = judged_.loss;
  trace_.start_x_error = trace_.last.x_error;
  set_scales();
  observe(judged_.loss);
  keep_point();
  status_ = judge(theta);
  watch_.resume();
  return status_;
}

// s = min(f₀ − f_L, the problem's scale). Where x is sought, a target τ is one of its error: the
// loss is quadratic in that, and is stopped at τ².
void Meter::set_scales() {
  trace_.x_scale = problem_.x_scale(judging());
  trace_.x_floor = problem_.x_floor(judging());
  if (!problem_.minimum()) return;
  const Real descent = trace_.start_loss - trace_.minimum;
  const Real own = problem_.loss_scale(judging());
  const Real scale = std::isfinite(own) && own > 0 ? std::min(own, descent) : descent;
  if (std::isnan(descent) || !std::isfinite(scale)) return;
  trace_.scale = std::max(scale, 0.0);
  next_target_ = kInfinity;
  // The minimum of a learned problem is the best loss known, which a longer run may better.
  if (budget_.target == 0 && problem_.is_learned()) return;
  const bool is_x_sought = trace_.aim == Aim::x;
  target_loss_ =
      target_at(is_x_sought ? budget_.target * std::abs(budget_.target) : budget_.target);
}

void Meter::prepare() {
  trace_.first_oracle_nanoseconds = monotonic_nanoseconds();
  const double limit = budget_.seconds / seconds_per_tick();  // calibrated off the clock
  if (limit < static_cast<double>(kNoLimit)) most_ticks_ = static_cast<std::uint64_t>(limit);
  if (!problem_.is_learned()) return;
  problem_.draw_validation(validation_);
  if (iteration_ > 0) draw_batch();  // the first is the problem's own
}

void Meter::persist(Archive& archive) {
  double wall = watch_.seconds(), processor = watch_.processor_seconds();
  archive(counts_, work_, iteration_, next_kept_, best_loss_, next_target_, target_loss_,
          targets_met_, stall_loss_, stall_iteration_, status_, batch_loss_, batch_x_error_,
          judged_.loss, judged_theta_, previous_, wall, processor);
  const bool are_spectra_wanted = trace_.spectra.are_wanted;  // by who goes on
  archive.raw(&trace_, sizeof trace_);  // plain data, but for atomics that nobody waits for
  trace_.spectra.are_wanted = are_spectra_wanted;
  if (!archive.is_reading()) return;
  require_sound();
  trace_.is_finished = false;
  watch_.set(wall, processor);
  prepare();
  watch_.resume();
}

// What a file brought back is this run's, or nothing: sizes and counts are within their laws.
void Meter::require_sound() const {
  const Index n = problem_.unknowns();
  const bool is_sound = targets_met_ >= 0 && targets_met_ <= kRungs && iteration_ >= 0 &&
                        work_ >= 0 && status_ == Status::running && batch_loss_.is_sound() &&
                        batch_x_error_.is_sound() && previous_.size() == n &&
                        (judged_theta_.size() == n || judged_theta_.size() == 0);
  require(is_sound, "the state of the meter is none of this run");
  const std::string defect = defect_of(trace_);
  require(defect.empty(), [&] { return "its trace holds " + defect; });
}

Status Meter::iterate(VectorRef theta) {
  ++iteration_;
  if (iteration_ >= next_kept_ || best_loss_ <= target_loss_) {
    watch_.pause();
    measure(theta);
    observe(judged_.loss);
    if (iteration_ >= next_kept_) keep_point();
    watch_.resume();
  }
  if (iteration_ + 1 >= next_kept_) previous_ = theta;
  status_ = judge(theta);
  if (problem_.has_fresh_batches() && status_ == Status::running) {
    watch_.pause();
    draw_batch();
    watch_.resume();
  }
  has_seen_batch_ = false;
  return status_;
}

void Meter::draw_batch() {
  if (!problem_.has_fresh_batches()) return;
  problem_.draw_batch(iteration_, batch_);
  samples_ = &batch_;
}

void Meter::note_batch(const Point& at) {
  watch_.pause();
  has_seen_batch_ = true;
  batch_loss_.add(at.loss);
  batch_x_error_.add(problem_.x_error(at.x(), *samples_));
  watch_.resume();
}

void Meter::finish(VectorRef theta, Status verdict) {
  watch_.pause();
  if (trace_.last.iteration != iteration_ || judged_theta_ != theta || !judged_.batch) {
    measure(theta);
    observe(judged_.loss);
  }
  trace_.last.counts = counts_;  // a library may have asked much since its last iteration
  trace_.last.work = work_;
  trace_.last.wall_seconds = watch_.seconds();
  trace_.last.processor_seconds = watch_.processor_seconds();
  const int points = trace_.points;  // the curve ends at the returned point
  if (points > 0 && trace_.point[points - 1].iteration == iteration_) trace_.points = points - 1;
  keep_point();
  keep_spectrum(true);
  if (problem_.is_learned() && !problem_.field()) show();
  if (verdict == Status::running) verdict = Status::converged;
  if (judged_.loss <= target_loss_) verdict = Status::target;
  if (!std::isfinite(judged_.loss)) verdict = Status::diverged;
  trace_.status = verdict;
}

// The loss and what surrounds it at θ, by the harness itself, charged to nobody.
void Meter::measure(VectorRef theta) {
  judged_theta_ = theta;
  problem_.forward(theta, judging(), judged_);
  TracePoint& last = trace_.last;
  last.iteration = iteration_;
  last.counts = counts_;
  last.work = work_;
  last.wall_seconds = watch_.seconds();
  last.processor_seconds = watch_.processor_seconds();
  last.loss = judged_.loss;
  last.x_error = problem_.x_error(judged_.x(), judging());
  const bool has_gradient = !problem_.is_learned() && problem_.products().has_pullback;
  last.gradient_norm = has_gradient ? judged_gradient_norm() : TracePoint::kAbsent;
  last.step_norm = (theta - previous_).norm();
  for (int i = 0; i < 2; ++i) {
    last.batch_loss[i] = batch_loss_.mean(TracePoint::kWindows[i]);
    last.batch_x_error[i] = batch_x_error_.mean(TracePoint::kWindows[i]);
  }
  const Series& series = problem_.series();
  if (series.names.empty()) return;
  Vector values(static_cast<Index>(series.names.size()));
  series.evaluate(problem_, theta, judged_, values);
  std::copy_n(values.data(), values.size(), last.series);
}

// A second pass over the network for a validation of many samples would cost more than the step.
Real Meter::judged_gradient_norm() {
  judged_g_.resize(problem_.outputs(), problem_.samples());
  judged_gradient_.resize(problem_.unknowns());
  problem_.cotangent(judged_, judged_g_);
  problem_.pullback(judged_g_, judged_gradient_, judged_);
  return judged_gradient_.norm();
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
  if (std::isnan(batch_loss_.last())) return Status::diverged;
  if (loss <= target_loss_) return Status::target;
  if (!problem_.is_learned() && has_stalled()) return Status::stalled;
  if (work_ >= budget_.work || iteration_ >= budget_.iterations) return Status::budget;
  if (is_out_of_time()) {
    trace_.stopped_by_clock = true;
    return Status::budget;
  }
  return Status::running;
}

}  // namespace isoline::optimizers
