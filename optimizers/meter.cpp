// The meter: the oracles that a method may call, counted.
#include "optimizers/meter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/status.h"

namespace isoline::optimizers {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
constexpr Real kNone = -kInfinity;  // a loss that is never reached

// Whether a state that was read from a file is one of this problem.
bool is_within(const problems::Refinement::State& state, const problems::Refinement* of) {
  return state.epochs >= 0 && state.iterations >= (of ? of->first : 1) &&
         state.iterations <= (of ? of->most : 1);
}

}  // namespace

void InARow::add_outcome(const FailedEvaluations& all) {
  failed = all.total == std::exchange(known, all.total) ? 0 : failed + 1;
  const std::int64_t most =
      all.most_in_a_row > 0 ? all.most_in_a_row : std::max<std::int64_t>(100, 10 * x.size());
  if (failed < most) return;
  const bool is_kept = all.kept > 0 && all.kept == all.total;
  throw std::runtime_error(fmt::format("{} evaluations in a row failed{}{}", failed,
                                       is_kept ? "; the last: " : "",
                                       is_kept ? all.reason[all.kept - 1] : ""));
}

Meter::Meter(const Problem& problem, const Budget& budget, OracleSet granted, Trace& trace,
             Observers observers)
    : problem_(problem),
      budget_(budget),
      granted_(granted),
      trace_(trace),
      observers_(std::move(observers)),
      samples_(&problem.batch()),
      prices_(problem.prices()),
      are_products_at_once_(problem.products().are_at_once),
      best_loss_(kInfinity),
      next_target_(kNone),
      target_loss_(kNone),
      next_x_goal_(kNone),
      stall_loss_(std::numeric_limits<Real>::max()),
      target_x_error_(kNone),
      most_discrepancy_(budget.discrepancy > 0 && problem.noise_level()
                            ? budget.discrepancy * *problem.noise_level()
                            : kNone),
      most_work_(budget.work -
                 (problem.is_learned() ? 0 : prices_[static_cast<std::size_t>(Oracle::forward)])),
      paid_loss_(std::nan("")),
      refinement_(problem.refinement()),
      solve_iterations_(problem.solve_iterations(problem.batch())) {
  refined_.iterations = solve_iterations_;
  trace_.prices = prices_;
  trace_.is_learned = problem.is_learned();
  OracleSet products = granted;
  products.remove(Oracle::forward);
  trace_.counts_rounds =
      !problem.is_learned() && (products.is_empty() || problem.products().are_at_once);
  name_series({});
  trace_.aim = problem.aim();
  trace_.minimum = problem.minimum().value_or(std::nan(""));
  trace_.noise_level = problem.noise_level().value_or(std::nan(""));
  trace_.is_bounded = problem.bounds() != nullptr;
  if (budget.discrepancy > 0 && !problem.noise_level())
    set_text(trace_.message,
             "the discrepancy principle has no effect: the problem states no level of noise");
  const bool is_kept = problem.has_identity_network() && !problem.is_learned() &&
                       problem.unknowns() <= Trace::kUnknowns;
  trace_.unknowns = is_kept ? static_cast<int>(problem.unknowns()) : 0;
}

void Meter::linearize(VectorRef theta, Linearization& at) {
  charge_forward(theta);
  at.meter_ = this;
  at.problem_ = &problem_;
  at.has_jacobian_ = at.has_hessian_ = at.has_sparse_ = false;
  problem_.forward(theta, *samples_, at.point_);
  in_a_row_.add_outcome(trace_.failures);
  see(at.point_, theta);
  disturb(at.point_);
  if (problem_.is_learned() && !has_seen_batch_) note_batch(at.point_);
}

void Meter::linearize_physics(BatchRef x, Linearization& at) {
  charge(Oracle::forward);
  at.meter_ = this;
  at.problem_ = &problem_;
  at.has_jacobian_ = at.has_hessian_ = at.has_sparse_ = false;
  problem_.physics_forward(x, *samples_, at.point_);
  disturb(at.point_);
}

// After the loss without jitter has been seen.
void Meter::disturb(Point& at) {
  const problems::Jitter* const jitter = problem_.jitter();
  if (!jitter) return;
  jitter->disturb(disturbed_++, samples_->target, at.y);
  at.loss = problem_.loss_of(at.y);
}

const Matrix& Meter::truth() {
  charge(Oracle::truth);
  return samples_->truth;
}

Real Meter::loss(VectorRef theta) {
  charge_forward(theta);
  problem_.forward(theta, *samples_, point_);
  in_a_row_.add_outcome(trace_.failures);
  see(point_, theta);
  disturb(point_);
  return point_.loss;
}

void Meter::refuse(Oracle oracle) const {
  throw std::logic_error(fmt::format(
      "the method called the oracle '{}', which it does not declare as needed", name_of(oracle)));
}

void Meter::exhaust() {
  is_exhausted_ = true;
  throw BudgetSpent();
}

// A point that was paid for when it was judged, or by the last call, is not paid for twice.
void Meter::charge_forward(VectorRef theta) {
  in_a_row_.known = trace_.failures.total;  // also those of the harness's own evaluations
  bool is_paid = is_prepaid_ && theta.size() == judged_theta_.size() && theta == judged_theta_;
  if (!problem_.is_learned() && !problem_.jitter()) {
    in_a_row_.add(theta);
    if (in_a_row_.is_of_one_x()) exhaust();
    is_paid = is_paid || in_a_row_.repeats > 0;
  }
  const bool is_announced =
      next_announced_ < announced_.cols() && announced_.col(next_announced_) == theta;
  next_announced_ = is_announced ? next_announced_ + 1 : announced_.cols();
  if (is_paid && is_granted(Oracle::forward)) {
    is_prepaid_ = false;
    return;
  }
  charge(Oracle::forward);
  if (!is_announced) return;
  for (std::size_t i = 0; i < kWorkers.size(); ++i)
    if (in_batch_ % kWorkers[i] != 0) ++spared_[i];
  ++in_batch_;
}

void Meter::announce(const Matrix& thetas) {
  if (problem_.is_learned()) return;
  const std::int64_t price = prices_[static_cast<std::size_t>(Oracle::forward)];
  const std::int64_t affordable = (most_work_ - work_) / price + (is_prepaid_ ? 1 : 0);
  announced_ = thetas.leftCols(std::clamp<std::int64_t>(affordable, 0, thetas.cols()));
  next_announced_ = in_batch_ = 0;
  problem_.begin_forwards(announced_);
}

// So many forwards within one call of a product.
void Meter::share_rounds(std::int64_t calls) {
  for (std::size_t i = 0; i < kWorkers.size(); ++i)
    spared_[i] += calls - (calls + kWorkers[i] - 1) / kWorkers[i];
}

Rounds Meter::rounds() const {
  Rounds rounds;
  for (std::size_t i = 0; i < kWorkers.size(); ++i) rounds[i] = work_ - spared_[i];
  return rounds;
}

void Meter::count_into(TracePoint& point) const {
  point.counts = counts_;
  point.work = work_;
  point.rounds = rounds();
}

// For a direct problem, an evaluated point that is neither the last nor the best one already
// counted costs a forward; false if the budget has none left.
bool Meter::pay_for_judged() {
  if (problem_.is_learned() || judged_.loss == paid_loss_ || judged_.loss == best_loss_)
    return true;
  // A method that sees noisy losses keeps a point that is not the best.
  if (problem_.jitter() && judged_theta_ == accepted_) return true;
  constexpr auto kForward = static_cast<std::size_t>(Oracle::forward);
  if (work_ + prices_[kForward] > budget_.work) {
    is_exhausted_ = true;
    return false;
  }
  work_ += prices_[kForward];
  ++counts_[kForward];
  count_into(trace_.last);
  paid_loss_ = judged_.loss;
  return is_prepaid_ = true;
}

void Meter::claim(std::string_view words) { set_text(trace_.claimed, words); }

void Meter::name_series(const std::vector<std::string>& names) {
  std::vector<std::string> all = problem_.series().names;
  all.insert(all.end(), names.begin(), names.end());
  const std::string text = fmt::format("{}", fmt::join(all, "\n"));
  require(all.size() <= Trace::kSeries && text.size() < Trace::kText,
          "the trace has no room for so many series");
  set_text(trace_.series_names, text);
}

void Meter::note(std::size_t which, Real value) {
  trace_.last.series[problem_.series().names.size() + which] = value;
}

void Meter::reach(Real loss) {
  if (!std::isfinite(loss)) return;
  trace_.best_loss = best_loss_;  // a run that is killed before its next kept point has reached it
  while (targets_met_ < kRungs) {
    next_target_ = target_at(rung(static_cast<std::size_t>(targets_met_)));
    if (!(loss <= next_target_)) return;
    note(trace_.hit[targets_met_++]);
  }
  next_target_ = kNone;
}

void Meter::reach_x(Real error) {
  while (x_targets_met_ < kRungs) {
    next_x_goal_ =
        x_goal(rung(static_cast<std::size_t>(x_targets_met_)), trace_.x_scale, trace_.x_floor);
    if (!(error <= next_x_goal_)) return;
    note(trace_.x_hit[x_targets_met_++]);
  }
  next_x_goal_ = kNone;
}

void Meter::note(TraceHit& hit) const {
  hit.work = work_;
  hit.counts = counts_;
  hit.rounds = rounds();
  hit.wall_seconds = watch_.seconds();
  hit.iteration = iteration_;
}

// The meter as the harness has it: a run begun, traced, judged and ended.

Status Meter::begin(VectorRef theta) {
  prepare();
  for (const auto& observer : observers_) observer->begin(*this);
  previous_ = theta;
  measure(theta);
  accepted_ = theta;
  trace_.start_loss = judged_.loss;
  trace_.start_x_error = trace_.last.x_error;
  start_gradient_ = trace_.last.gradient_norm;
  set_scales();
  observe(judged_.loss, judged_theta_);
  observe_x(trace_.last.x_error);
  keep_point();
  refine(theta);
  status_ = judge(theta);
  watch_.resume();
  return status_;
}

// s = min(f₀ − f_L, the problem's scale). If the criterion is the error in x, a target τ refers to
// that error.
void Meter::set_scales() {
  trace_.x_scale = problem_.x_scale(judging());
  trace_.x_floor = problem_.x_floor(judging());
  if (!problem_.is_learned() && trace_.aim == Aim::x && std::isfinite(trace_.x_scale))
    next_x_goal_ = kInfinity;
  const bool stops_at_target = budget_.target > 0 && most_discrepancy_ == kNone;
  if (trace_.aim == Aim::x && stops_at_target && std::isfinite(trace_.x_scale))
    target_x_error_ = x_goal(budget_.target, trace_.x_scale, trace_.x_floor);
  if (!problem_.minimum()) return;
  const Real descent = trace_.start_loss - trace_.minimum;
  const Real own = problem_.loss_scale(judging());
  const Real scale = std::isfinite(own) && own > 0 ? std::min(own, descent) : descent;
  if (std::isnan(descent) || !std::isfinite(scale)) return;
  trace_.scale = std::max(scale, 0.0);
  next_target_ = kInfinity;
  // The minimum of a learned problem is the best loss known, which a longer run may better.
  if (budget_.target == 0 && problem_.is_learned()) return;
  if (trace_.aim == Aim::loss && most_discrepancy_ == kNone)
    target_loss_ = target_at(budget_.target);
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
  archive(counts_, work_, spared_, disturbed_, iteration_, next_kept_, best_loss_, next_target_,
          target_loss_, target_x_error_, targets_met_, next_x_goal_, x_targets_met_, stall_loss_,
          stall_iteration_, status_, batch_loss_, batch_x_error_, judged_.loss, judged_theta_,
          paid_loss_, is_prepaid_, previous_, wall, processor, refined_, known_theta_, known_J_,
          known_by_.noise, known_by_.step, known_by_.is_central, enough_of_deviation_,
          start_gradient_, origin_, in_a_row_.x, in_a_row_.repeats, in_a_row_.failed,
          in_a_row_.known);
  const bool wants_spectra = trace_.wants_spectra;  // the caller decides this, not the file
  const CallReport since = trace_.calls;
  archive.raw(&trace_, sizeof trace_);  // plain data; no reader waits for its atomics
  trace_.wants_spectra = wants_spectra;
  if (!archive.is_reading()) return;
  trace_.calls.made += since.made;
  trace_.calls.answered += since.answered;
  // The state from a file must be valid for this run: all sizes and counts are in their ranges.
  const Index n = problem_.unknowns();
  const bool is_sound =
      targets_met_ >= 0 && targets_met_ <= kRungs && x_targets_met_ >= 0 &&
      x_targets_met_ <= kRungs && iteration_ >= 0 && work_ >= 0 && status_ == Status::running &&
      batch_loss_.is_sound() && batch_x_error_.is_sound() && previous_.size() == n &&
      (judged_theta_.size() == n || judged_theta_.size() == 0) && is_within(refined_, refinement_);
  require(is_sound, "the state of the meter belongs to another run");
  const std::string defect = defect_of(trace_);
  require(defect.empty(), [&] { return "its trace holds " + defect; });
  accepted_ = judged_theta_;
  trace_.is_finished = false;
  watch_.set(wall, processor);
  prepare();
  watch_.resume();
}

Status Meter::iterate(VectorRef theta) {
  ++iteration_;
  // The discrepancy principle requires each iterate, also those that are not kept.
  if (iteration_ >= next_kept_ || best_loss_ <= target_loss_ || most_discrepancy_ > kNone) {
    watch_.pause();
    if (look_at(theta) && iteration_ >= next_kept_) keep_point();
    watch_.resume();
  }
  if (iteration_ + 1 >= next_kept_) previous_ = theta;
  status_ = judge(theta);
  if (problem_.has_fresh_batches() && status_ == Status::running) {
    watch_.pause();
    refine(theta);
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
  if (!refinement_) return;
  batch_.context.setConstant(static_cast<Real>(refined_.iterations));
  solve_iterations_ = refined_.iterations;
}

// By the validation loss, off the clock and at no cost, as what is judged.
void Meter::refine(VectorRef theta) {
  if (!refinement_ || refinement_->step == 0 || iteration_ % problems::Refinement::kEpoch != 0)
    return;
  problem_.forward(theta, validation_, watched_);
  refinement_->see(watched_.loss, refined_);
}

void Meter::note_batch(const Point& at) {
  watch_.pause();
  has_seen_batch_ = true;
  batch_loss_.add(at.loss);
  batch_x_error_.add(problem_.x_error(at.x(), *samples_));
  watch_.resume();
}

Vector Meter::finish(VectorRef theta, Status verdict) {
  watch_.pause();
  if (trace_.last.iteration != iteration_ || judged_theta_ != theta) {
    look_at(theta);
  } else {
    const TracePoint last = trace_.last;
    if (!judged_.batch) measure(theta);  // in a run that was continued here; it is paid for
    trace_.last = last;
    if (!problem_.is_learned()) measure_series();  // those of the calls since then
  }
  knows_exact_ = false;
  leave_failed_point(verdict);
  if (in_a_row_.is_of_one_x() && verdict == Status::budget) {
    verdict = Status::stalled;
    set_text(trace_.message,
             fmt::format("the method evaluated one x {} times in a row", InARow::kMostRepeats));
  }
  if (verdict == Status::running) verdict = Status::converged;
  if (is_target_met()) verdict = Status::target;
  if (is_at_noise()) verdict = Status::discrepancy;
  if (!std::isfinite(judged_.loss)) verdict = Status::diverged;
  if (verdict == Status::converged && !problem_.is_learned())
    if (const std::string why = doubt(); !why.empty()) {
      verdict = Status::unconfirmed;
      remark(why);
    }
  for (const auto& observer : observers_) observer->end(*this, verdict);
  count_into(trace_.last);  // a library may have made many calls since its last iteration
  trace_.last.wall_seconds = watch_.seconds();
  trace_.last.processor_seconds = watch_.processor_seconds();
  const int points = trace_.points;  // the curve ends at the returned point
  if (points > 0 && trace_.point[points - 1].iteration == iteration_) trace_.points = points - 1;
  keep_point();
  trace_.status = verdict;
  return judged_theta_;
}

// No run ends at a point whose evaluation failed while it has one with a value.
void Meter::leave_failed_point(Status& verdict) {
  if (std::isfinite(judged_.loss) || trace_.failures.total == 0 || !trace_.has_best) return;
  look_at(Eigen::Map<const Vector>(trace_.best, trace_.unknowns));
  if (verdict == Status::diverged || verdict == Status::running) verdict = Status::stalled;
}

// Judges θ, or the last that was, where the budget has no more for this one: then false.
bool Meter::look_at(VectorRef theta) {
  measure(theta);
  if (!pay_for_judged()) {
    measure(accepted_);
    return false;
  }
  accepted_ = judged_theta_;
  observe(judged_.loss, judged_theta_);
  observe_x(trace_.last.x_error);
  return true;
}

// The loss and related values at θ, evaluated by the harness; they count for no oracle.
void Meter::measure(VectorRef theta) {
  is_prepaid_ = is_prepaid_ && judged_theta_ == theta;
  problem_.forward(theta, judging(), judged_);
  judged_theta_ = theta;  // only where it could be
  TracePoint& last = trace_.last;
  last.iteration = iteration_;
  count_into(last);
  last.wall_seconds = watch_.seconds();
  last.processor_seconds = watch_.processor_seconds();
  last.loss = judged_.loss;
  last.x_error = problem_.x_error(judged_.x(), judging());
  last.gradient_norm = last.kkt_residual = TracePoint::kAbsent;
  if (problem_.noise_level()) last.discrepancy = problem_.discrepancy(judged_);
  // A second pass over the network for a validation of many samples would cost more than the step,
  // and differences would cost calls that the method does not make.
  const problems::Products has = problem_.products();
  if (measures_gradients_ && !problem_.is_learned() && has.has_pullback && !has.are_differences) {
    judged_g_.resize(problem_.outputs(), problem_.samples());
    judged_gradient_.resize(problem_.unknowns());
    problem_.cotangent(judged_, judged_g_);
    problem_.pullback(judged_g_, judged_gradient_, judged_);
    last.gradient_norm = judged_gradient_.norm();
    if (const Bounds* bounds = problem_.bounds())
      last.kkt_residual = (theta - bounds->nearest(theta - judged_gradient_)).norm();
  }
  last.step_norm = (theta - previous_).norm();
  for (int i = 0; i < 2; ++i) {
    last.batch_loss[i] = batch_loss_.mean(TracePoint::kWindows[i]);
    last.batch_x_error[i] = batch_x_error_.mean(TracePoint::kWindows[i]);
  }
  measure_series();
}

void Meter::measure_series() {
  const problems::Series& series = problem_.series();
  if (series.names.empty()) return;
  Vector values(static_cast<Index>(series.names.size()));
  series.evaluate(problem_, judged_theta_, judged_, values);
  std::copy_n(values.data(), values.size(), trace_.last.series);
}

bool Meter::has_stalled() {
  constexpr Real kStallDecrease = 1e-12;
  const std::int64_t most = budget_.stall.value_or(kStallIterations);
  if (stall_loss_ - best_loss_ > kStallDecrease * std::abs(stall_loss_)) {
    stall_loss_ = best_loss_;
    stall_iteration_ = iteration_;
  }
  return most > 0 && iteration_ - stall_iteration_ >= most;
}

// `judged_` holds the loss at the last kept iteration, which is this one for the first hundred.
Status Meter::judge(VectorRef theta) {
  constexpr Real kDivergence = 1e12;
  const Real loss = judged_.loss;
  const bool has_scale = trace_.start_loss > 0;  // not where the start is the solution
  if (!is_finite(theta) || !std::isfinite(loss) ||
      (has_scale && loss > kDivergence * trace_.start_loss))
    return Status::diverged;
  if (std::isnan(batch_loss_.last())) return Status::diverged;
  if (is_target_met()) return Status::target;
  if (is_at_noise()) return Status::discrepancy;
  if (!problem_.is_learned() && has_stalled()) return Status::stalled;
  if (is_out_of_work() || iteration_ >= budget_.iterations) return Status::budget;
  if (is_out_of_time()) {
    trace_.stopped_by_clock = true;
    return Status::budget;
  }
  return Status::running;
}

void Meter::keep_point() {
  const int index = trace_.points;
  if (index >= Trace::kPoints) return;
  trace_.point[index] = trace_.last;
  for (const auto& observer : observers_) observer->keep(*this, index);
  trace_.points = index + 1;
  trace_.best_loss = best_loss_;
  next_kept_ = next_kept_after(iteration_);
}

void Meter::remark(std::string_view sentence) {
  if (trace_.message[0] == '\0') set_text(trace_.message, sentence);
}

Real Meter::residual_unit() const {
  const Real length = std::sqrt(2 * trace_.start_loss);
  const bool is_scaled =
      (problem_.own_units().scales.size() > 0 || problem_.model() != nullptr) && length > 0;
  return is_scaled && std::isfinite(length) ? std::exp2(-std::round(std::log2(length))) : 1;
}

}  // namespace isoline::optimizers
