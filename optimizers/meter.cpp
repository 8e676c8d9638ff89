// The meter: the oracles that a method may call, counted.
#include "optimizers/meter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"

namespace isoline::optimizers {
namespace {

// Whether a state that was read from a file is one of this problem.
bool is_within(const problems::Refinement::State& state, const problems::Refinement* of) {
  return state.epochs >= 0 && state.iterations >= (of ? of->first : 1) &&
         state.iterations <= (of ? of->most : 1);
}

}  // namespace

Meter::Meter(const Problem& problem, const Budget& budget, OracleSet granted, Trace& trace,
             Observers observers)
    : problem_(problem),
      budget_(budget),
      granted_(granted),
      trace_(trace),
      observers_(std::move(observers)),
      samples_(&problem.batch()),
      ledger_(problem, budget.work),
      goals_(problem, budget, trace),
      solve_iterations_(problem.solve_iterations(problem.batch())) {
  refined_.iterations = solve_iterations_;
  trace_.prices = problem.prices();
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
  if (problem_.is_learned() && !means_.has_this_step) note_batch(at.point_);
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

// A point that was paid for when it was judged, or by the last call, is not paid for twice.
void Meter::charge_forward(VectorRef theta) {
  in_a_row_.known = trace_.failures.total;  // also those of the harness's own evaluations
  bool is_paid =
      judged_.is_prepaid && theta.size() == judged_.theta.size() && theta == judged_.theta;
  if (!problem_.is_learned() && !problem_.jitter()) {
    in_a_row_.add(theta);
    if (in_a_row_.is_of_one_x()) ledger_.exhaust();
    is_paid = is_paid || in_a_row_.repeats > 0;
  }
  const bool is_announced = ledger_.takes_announced(theta);
  if (is_paid && is_granted(Oracle::forward)) {
    judged_.is_prepaid = false;
    return;
  }
  charge(Oracle::forward);
  if (is_announced) ledger_.share_batch();
}

void Meter::announce(const Matrix& thetas) {
  if (!problem_.is_learned())
    problem_.begin_forwards(ledger_.announce(thetas, judged_.is_prepaid ? 1 : 0));
}

// For a direct problem, an evaluated point that is neither the last nor the best one already
// counted costs a forward; false if the budget has none left.
bool Meter::pay_for_judged() {
  const Real loss = judged_.at.loss;
  if (problem_.is_learned() || loss == judged_.paid_loss || loss == goals_.best_loss()) return true;
  // A method that sees noisy losses keeps a point that is not the best.
  if (problem_.jitter() && judged_.theta == judged_.accepted) return true;
  if (!ledger_.pay(Oracle::forward, 1)) {
    ledger_.close();
    return false;
  }
  ledger_.count_into(trace_.last);
  judged_.paid_loss = loss;
  return judged_.is_prepaid = true;
}

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

void Meter::note(TraceHit& hit) const {
  ledger_.count_into(hit);
  hit.wall_seconds = watch_.seconds();
  hit.iteration = iteration_;
}

// The meter as the harness has it: a run begun, traced, judged and ended.

Status Meter::begin(VectorRef theta) {
  prepare();
  for (const auto& observer : observers_) observer->begin(*this);
  previous_ = theta;
  measure(theta);
  judged_.accepted = theta;
  trace_.start_loss = judged_.at.loss;
  trace_.start_x_error = trace_.last.x_error;
  start_gradient_ = trace_.last.gradient_norm;
  goals_.begin(problem_, budget_, judging());
  observe(judged_.at.loss, judged_.theta);
  observe_x(trace_.last.x_error);
  keep_point();
  refine(theta);
  status_ = judge(theta);
  watch_.resume();
  return status_;
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
  ledger_.persist(archive);
  goals_.persist(archive);
  means_.persist(archive);
  in_a_row_.persist(archive);
  known_.persist(archive);
  archive(disturbed_, iteration_, next_kept_, status_, judged_.at.loss, judged_.theta,
          judged_.paid_loss, judged_.is_prepaid, previous_, wall, processor, refined_,
          start_gradient_);
  const bool wants_spectra = trace_.wants_spectra;  // the caller decides this, not the file
  const CallReport since = trace_.calls;
  archive.raw(&trace_, sizeof trace_);  // plain data; no reader waits for its atomics
  trace_.wants_spectra = wants_spectra;
  if (!archive.is_reading()) return;
  trace_.calls.made += since.made;
  trace_.calls.answered += since.answered;
  // The state from a file must be valid for this run: all sizes and counts are in their ranges.
  const Index n = problem_.unknowns();
  const bool is_sound = goals_.is_sound() && ledger_.is_sound() && means_.is_sound() &&
                        iteration_ >= 0 && status_ == Status::running && previous_.size() == n &&
                        (judged_.theta.size() == n || judged_.theta.size() == 0) &&
                        is_within(refined_, problem_.refinement());
  require(is_sound, "the state of the meter belongs to another run");
  const std::string defect = defect_of(trace_);
  require(defect.empty(), [&] { return "its trace holds " + defect; });
  judged_.accepted = judged_.theta;
  trace_.is_finished = false;
  watch_.set(wall, processor);
  prepare();
  watch_.resume();
}

Status Meter::iterate(VectorRef theta) {
  ++iteration_;
  if (iteration_ >= next_kept_ || goals_.wants_each_iterate()) {
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
  means_.has_this_step = false;
  return status_;
}

void Meter::draw_batch() {
  if (!problem_.has_fresh_batches()) return;
  problem_.draw_batch(iteration_, batch_);
  samples_ = &batch_;
  if (!problem_.refinement()) return;
  batch_.context.setConstant(static_cast<Real>(refined_.iterations));
  solve_iterations_ = refined_.iterations;
}

// By the validation loss, off the clock and at no cost, as what is judged.
void Meter::refine(VectorRef theta) {
  const problems::Refinement* const refinement = problem_.refinement();
  if (!refinement || refinement->step == 0 || iteration_ % problems::Refinement::kEpoch != 0)
    return;
  Point watched;
  problem_.forward(theta, validation_, watched);
  refinement->see(watched.loss, refined_);
}

void Meter::note_batch(const Point& at) {
  watch_.pause();
  means_.has_this_step = true;
  means_.loss.add(at.loss);
  means_.x_error.add(problem_.x_error(at.x(), *samples_));
  watch_.resume();
}

Vector Meter::finish(VectorRef theta, Status verdict) {
  watch_.pause();
  if (trace_.last.iteration != iteration_ || judged_.theta != theta) {
    look_at(theta);
  } else {
    const TracePoint last = trace_.last;
    if (!judged_.at.batch) measure(theta);  // in a run that was continued here; it is paid for
    trace_.last = last;
    if (!problem_.is_learned()) measure_series();  // those of the calls since then
  }
  known_.is_exact = false;
  leave_failed_point(verdict);
  if (in_a_row_.is_of_one_x() && verdict == Status::budget) {
    verdict = Status::stalled;
    set_text(trace_.message, InARow::kOfOneX);
  }
  if (verdict == Status::running) verdict = Status::converged;
  if (goals_.is_target_met(judged_.at.loss, trace_.last.x_error)) verdict = Status::target;
  if (goals_.is_at_noise(trace_.last.discrepancy)) verdict = Status::discrepancy;
  if (!std::isfinite(judged_.at.loss) && verdict != Status::failed) verdict = Status::diverged;
  if (verdict == Status::converged && !problem_.is_learned())
    if (const std::string why = doubt(); !why.empty()) {
      verdict = Status::unconfirmed;
      remark(why);
    }
  for (const auto& observer : observers_) observer->end(*this, verdict);
  ledger_.count_into(trace_.last);  // a library may have made many calls since its last iteration
  trace_.last.wall_seconds = watch_.seconds();
  trace_.last.processor_seconds = watch_.processor_seconds();
  const int points = trace_.points;  // the curve ends at the returned point
  if (points > 0 && trace_.point[points - 1].iteration == iteration_) trace_.points = points - 1;
  keep_point();
  trace_.status = verdict;
  return judged_.theta;
}

// Judges θ, or the last that was, where the budget has no more for this one: then false.
bool Meter::look_at(VectorRef theta) {
  measure(theta);
  if (!pay_for_judged()) {
    measure(judged_.accepted);
    return false;
  }
  judged_.accepted = judged_.theta;
  observe(judged_.at.loss, judged_.theta);
  observe_x(trace_.last.x_error);
  return true;
}

// The loss and related values at θ, evaluated by the harness; they count for no oracle.
void Meter::measure(VectorRef theta) {
  judged_.is_prepaid = judged_.is_prepaid && judged_.theta == theta;
  problem_.forward(theta, judging(), judged_.at);
  judged_.theta = theta;  // only where it could be
  TracePoint& last = trace_.last;
  last.iteration = iteration_;
  ledger_.count_into(last);
  last.wall_seconds = watch_.seconds();
  last.processor_seconds = watch_.processor_seconds();
  last.loss = judged_.at.loss;
  last.x_error = problem_.x_error(judged_.at.x(), judging());
  last.gradient_norm = last.kkt_residual = TracePoint::kAbsent;
  if (problem_.noise_level()) last.discrepancy = problem_.discrepancy(judged_.at);
  // A second pass over the network for a validation of many samples would cost more than the step,
  // and differences, or products of another program, calls that the method does not make.
  const problems::Products has = problem_.products();
  const bool is_by_method = is_granted(Oracle::pullback) || is_granted(Oracle::jacobian);
  const bool is_dear = has.are_differences ||
                       (problem_.is_elsewhere() && !is_by_method && problem_.is_least_squares());
  if (judged_.has_gradient && !problem_.is_learned() && has.has_pullback && !is_dear) {
    judged_.g.resize(problem_.outputs(), problem_.samples());
    judged_.gradient.resize(problem_.unknowns());
    problem_.cotangent(judged_.at, judged_.g);
    problem_.pullback(judged_.g, judged_.gradient, judged_.at);
    last.gradient_norm = judged_.gradient.norm();
    if (const Bounds* bounds = problem_.bounds())
      last.kkt_residual = (theta - bounds->nearest(theta - judged_.gradient)).norm();
  }
  last.step_norm = (theta - previous_).norm();
  for (int i = 0; i < 2; ++i) {
    last.batch_loss[i] = means_.loss.mean(TracePoint::kWindows[i]);
    last.batch_x_error[i] = means_.x_error.mean(TracePoint::kWindows[i]);
  }
  measure_series();
}

void Meter::measure_series() {
  const problems::Series& series = problem_.series();
  if (series.names.empty()) return;
  Vector values(static_cast<Index>(series.names.size()));
  series.evaluate(problem_, judged_.theta, judged_.at, values);
  std::copy_n(values.data(), values.size(), trace_.last.series);
}

// `judged_` holds the loss at the last kept iteration, which is this one for the first hundred.
Status Meter::judge(VectorRef theta) {
  constexpr Real kDivergence = 1e12;
  const Real loss = judged_.at.loss;
  const bool has_scale = trace_.start_loss > 0;  // not where the start is the solution
  if (!is_finite(theta) || !std::isfinite(loss) ||
      (has_scale && loss > kDivergence * trace_.start_loss))
    return Status::diverged;
  if (std::isnan(means_.loss.last())) return Status::diverged;
  if (goals_.is_target_met(judged_.at.loss, trace_.last.x_error)) return Status::target;
  if (goals_.is_at_noise(trace_.last.discrepancy)) return Status::discrepancy;
  return limit();
}

Status Meter::limit() {
  const bool do_all_fail = in_a_row_.failed > kStallIterations / 2;  // their number ends the run
  if (!problem_.is_learned() && !do_all_fail &&
      goals_.has_stalled(iteration_, budget_.stall.value_or(kStallIterations)))
    return Status::stalled;
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
  trace_.best_loss = goals_.best_loss();
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
