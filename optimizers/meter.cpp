// The meter: the oracles that a method may call, counted.
#include "optimizers/meter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/decompose.h"
#include "core/errors.h"
#include "core/frames.h"
#include "core/status.h"
#include "optimizers/differences.h"
#include "optimizers/examination.h"

namespace isoline::optimizers {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
constexpr Real kNone = -kInfinity;  // a loss that is never reached

bool are_same(const Vector& a, const Vector& b) { return a.size() == b.size() && a == b; }

// Whether a state that was read from a file is one of this problem.
bool is_within(const problems::Refinement::State& state, const problems::Refinement* of) {
  return state.epochs >= 0 && state.iterations >= (of ? of->first : 1) &&
         state.iterations <= (of ? of->most : 1);
}

// "NAME tab UNIT" of each unknown, a line each; empty where the problem declares neither.
std::string names_text(const Problem& problem) {
  const problems::Model* const model = problem.model();
  const std::vector<std::string>&names = model ? model->names : problem.names(),
        &units = model ? model->units : problem.units();
  const auto n = model ? names.size() : static_cast<std::size_t>(problem.unknowns());
  require((names.empty() || names.size() == n) && (units.empty() || units.size() == n), [&] {
    return fmt::format("the problem has {} unknowns, but declares {} names and {} units", n,
                       names.size(), units.size());
  });
  std::string text;
  for (std::size_t i = 0; i < n && !(names.empty() && units.empty()); ++i)
    text += fmt::format("{}\t{}\n",
                        names.empty() || names[i].empty() ? fmt::format("x{}", i + 1) : names[i],
                        units.empty() ? "" : units[i]);
  require(text.size() < Trace::Answer::kNames, [&] {
    return fmt::format("the names and units of the unknowns have {} bytes, but at most {} fit",
                       text.size(), Trace::Answer::kNames - 1);
  });
  return text;
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

Meter::Meter(const Problem& problem, const Budget& budget, OracleSet granted, Trace& trace)
    : problem_(problem),
      budget_(budget),
      granted_(granted),
      trace_(trace),
      samples_(&problem.batch()),
      prices_(problem.prices()),
      are_products_at_once_(problem.products().are_at_once),
      best_loss_(kInfinity),
      next_target_(kNone),
      target_loss_(kNone),
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
                       problem.unknowns() <= Trace::Answer::kUnknowns;
  trace_.answer.unknowns = is_kept ? static_cast<int>(problem.unknowns()) : 0;
  if (is_kept) describe_unknowns();
  const problems::Model* const model = problem.model();
  const Index unknowns = model ? std::ssize(model->names) : problem.inputs();
  const bool is_small = unknowns <= Trace::kInputs && problem.residuals() <= Trace::kOutputs &&
                        problem.samples() == 1;
  trace_.path_inputs = is_small ? static_cast<int>(unknowns) : 0;
  trace_.path_outputs = is_small ? static_cast<int>(problem.residuals()) : 0;
}

void Meter::linearize(VectorRef theta, Linearization& at) {
  charge_forward(theta);
  at.meter_ = this;
  at.problem_ = &problem_;
  at.has_jacobian_ = at.has_hessian_ = at.has_sparse_ = false;
  problem_.forward(theta, *samples_, at.point_);
  in_a_row_.add_outcome(trace_.failures);
  see(at.point_.loss, theta);
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
  see(point_.loss, theta);
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
    TraceHit& hit = trace_.hit[targets_met_++];
    hit.work = work_;
    hit.counts = counts_;
    hit.rounds = rounds();
    hit.wall_seconds = watch_.seconds();
    hit.iteration = iteration_;
  }
  next_target_ = kNone;
}

// The meter as the harness has it: a run begun, traced, judged and ended.

Status Meter::begin(VectorRef theta) {
  prepare();
  if (const auto& field = problem_.field()) {
    const Picture target(judging().target, field);
    const Picture truth(judging().truth, field, problem_.history());
    const Matrix& context = judging().context;
    const auto cells = static_cast<std::size_t>(field->rows * field->columns);
    open_frames(trace_.frames, field->rows, field->columns, target.cells(), truth.cells(),
                {context.data(), field->context.empty() ? 0 : cells});
  }
  previous_ = theta;
  measure(theta);
  accepted_ = theta;
  trace_.start_loss = judged_.loss;
  trace_.start_x_error = trace_.last.x_error;
  start_gradient_ = trace_.last.gradient_norm;
  set_scales();
  observe(judged_.loss, judged_theta_);
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
          target_loss_, target_x_error_, targets_met_, stall_loss_, stall_iteration_, status_,
          batch_loss_, batch_x_error_, judged_.loss, judged_theta_, paid_loss_, is_prepaid_,
          previous_, wall, processor, refined_, known_theta_, known_J_, known_by_.noise,
          known_by_.step, known_by_.is_central, enough_of_deviation_, start_gradient_, origin_,
          in_a_row_.x, in_a_row_.repeats, in_a_row_.failed, in_a_row_.known);
  const bool are_spectra_wanted =
      trace_.spectra.are_wanted;  // the caller decides this, not the file
  const CallReport since = trace_.calls;
  archive.raw(&trace_, sizeof trace_);  // plain data; no reader waits for its atomics
  trace_.spectra.are_wanted = are_spectra_wanted;
  if (!archive.is_reading()) return;
  trace_.calls.made += since.made;
  trace_.calls.answered += since.answered;
  // The state from a file must be valid for this run: all sizes and counts are in their ranges.
  const Index n = problem_.unknowns();
  const bool is_sound = targets_met_ >= 0 && targets_met_ <= kRungs && iteration_ >= 0 &&
                        work_ >= 0 && status_ == Status::running && batch_loss_.is_sound() &&
                        batch_x_error_.is_sound() && previous_.size() == n &&
                        (judged_theta_.size() == n || judged_theta_.size() == 0) &&
                        is_within(refined_, refinement_);
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
  if (trace_.last.iteration != iteration_ || judged_theta_ != theta || !judged_.batch)
    look_at(theta);
  else if (!problem_.is_learned())
    measure_series();  // those of the calls since then
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
      if (trace_.message[0] == '\0') set_text(trace_.message, why);
    }
  if (verdict != Status::unconfirmed) keep_uncertainty();
  count_into(trace_.last);  // a library may have made many calls since its last iteration
  trace_.last.wall_seconds = watch_.seconds();
  trace_.last.processor_seconds = watch_.processor_seconds();
  const int points = trace_.points;  // the curve ends at the returned point
  if (points > 0 && trace_.point[points - 1].iteration == iteration_) trace_.points = points - 1;
  keep_point();
  keep_spectrum(true);
  keep_returned();
  if (problem_.is_learned() && !problem_.field()) show();
  trace_.status = verdict;
  return judged_theta_;
}

// No run ends at a point whose evaluation failed while it has one with a value.
void Meter::leave_failed_point(Status& verdict) {
  if (std::isfinite(judged_.loss) || trace_.failures.total == 0 || !trace_.answer.has_best) return;
  look_at(Eigen::Map<const Vector>(trace_.answer.best, trace_.answer.unknowns));
  if (verdict == Status::diverged || verdict == Status::running) verdict = Status::stalled;
}

// J at the returned point: the exact one of the problem, that of the method, or by central
// differences, which count as calls of the run do. False where the budget has none left for them.
bool Meter::know_jacobian_at_end() {
  const problems::Products has = problem_.products();
  const bool offers_it = problem_.offers().contains(Oracle::jacobian);
  if (offers_it && !has.are_differences && !knows_exact_) {
    problem_.jacobian(known_J_, judged_);
    known_theta_ = judged_theta_;
    known_by_ = {};
    return knows_exact_ = true;
  }
  if (are_same(known_theta_, judged_theta_)) return true;
  try {
    const std::int64_t price =
        prices_[static_cast<std::size_t>(offers_it ? Oracle::jacobian : Oracle::forward)];
    const std::int64_t calls = offers_it ? 1 : 2 * problem_.unknowns();
    if (work_ + calls * price > budget_.work) return false;
    if (offers_it) {
      problem_.jacobian(known_J_, judged_);
      counts_[static_cast<std::size_t>(Oracle::jacobian)] += calls;
      work_ += calls * price;
      known_theta_ = judged_theta_;
      known_by_.noise = std::max(known_by_.noise, has.noise);
      trace_.difference_noise = has.noise;
      trace_.difference_step = has.step;
      return true;
    }
    Linearization at;
    DifferenceJacobian differences;
    const Vector theta = judged_theta_;
    if (known_J_.size() > 0) differences.know_noise(theta, known_by_.noise);
    linearize(theta, at);
    differences.renew(*this, theta, "central", at);
    return true;
  } catch (const BudgetSpent&) {
    return false;
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
  const bool was_known = are_same(known_theta_, judged_theta_);
  if (!know_jacobian_at_end()) return "no calls were left to see whether the gradient is small";
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
  if (!know_jacobian_at_end()) return "no calls were left to see whether the gradient is small";
  return doubt_of(at);
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

// The data that a run keeps about its path, off the clock: its curve, its path, its fields, the
// spectrum of J, and samples of the learned results.

void Meter::keep_point() {
  const int index = trace_.points;
  if (index >= Trace::kPoints) return;
  trace_.point[index] = trace_.last;
  if (trace_.path_inputs > 0) {
    const bool is_own = problem_.own_units().scales.size() > 0 || trace_.model_answer.unknowns > 0;
    const Matrix x = is_own ? Matrix(problem_.in_own_units(judged_theta_)) : judged_.x();
    std::copy_n(x.data(), x.size(), trace_.path_x[index]);
    std::copy_n(judged_.y.data(), judged_.y.size(), trace_.path_y[index]);
  }
  if (const auto& field = problem_.field()) {
    const Picture x(judged_.x(), field, problem_.history());  // of a history, y is a part
    keep_frame(trace_.frames, iteration_, x.cells(),
               field->is_history() ? std::span<const Real>() : Picture(judged_.y, field).cells());
  }
  keep_model_best();
  trace_.points = index + 1;
  trace_.best_loss = best_loss_;
  next_kept_ = next_kept_after(iteration_);
  keep_spectrum(false);
}

// The validation as it was last judged: its first small samples.
void Meter::show() {
  constexpr Index kMostSamples = 256;
  const auto keep = [&](const Matrix& all, Trace::Exhibit& shown) {
    if (all.size() == 0 || all.rows() > Trace::kExhibit) return;
    const Index most = std::min(kMostSamples, Trace::kExhibit / all.rows());
    shown.columns = static_cast<int>(std::min(most, all.cols()));
    std::copy_n(all.data(), all.rows() * shown.columns, shown.value);
    shown.rows = static_cast<int>(all.rows());
  };
  keep(validation_.target, trace_.shown_target);
  keep(judged_.x(), trace_.shown_x);
  keep(validation_.truth, trace_.shown_truth);
}

// At iterations 0, 1, 2, 4, 8, …, or the first kept one after each, and the last.
bool Meter::is_spectrum_due(bool is_last) const {
  const Trace::Spectra& kept = trace_.spectra;
  if (!kept.are_wanted || kept.taken == Trace::Spectra::kPlaces) return false;
  if (kept.taken == 0) return true;
  const std::int64_t last = kept.iteration[kept.taken - 1];
  return is_last ? iteration_ > last : iteration_ >= std::max<std::int64_t>(1, 2 * last);
}

// Over the batch of the step that led here. A J that is not finite has no spectrum.
void Meter::keep_spectrum(bool is_last) {
  constexpr Index kMostNumbers = Index{1} << 26;  // of J: half a gibibyte
  const Index rows = problem_.residuals(), columns = problem_.unknowns();
  if (!is_spectrum_due(is_last) || !problem_.offers().contains(Oracle::jacobian) ||
      std::min(rows, columns) > Trace::Spectra::kValues || rows * columns > kMostNumbers)
    return;
  Point point;
  Matrix J;  // (m·B, n)
  Vector sigma;
  problem_.forward(judged_theta_, *samples_, point);
  problem_.jacobian(J, point);
  if (!singular_values(J, sigma)) return;
  Trace::Spectra& kept = trace_.spectra;
  kept.values = static_cast<int>(sigma.size());
  std::copy_n(sigma.data(), sigma.size(), kept.sigma[kept.taken]);
  kept.iteration[kept.taken] = iteration_;
  ++kept.taken;
}

void Meter::describe_unknowns() {
  Trace::Answer& kept = trace_.answer;
  kept.names[names_text(problem_).copy(kept.names, Trace::Answer::kNames - 1)] = '\0';
  const problems::OwnUnits& own = problem_.own_units();
  kept.is_scaled = own.scales.size() > 0;
  std::ranges::copy(own.scales, kept.scale);
  const problems::Model* const model = problem_.model();
  if (model != nullptr) {
    require(model->names.size() <= Trace::ModelAnswer::kUnknowns, [&] {
      return fmt::format("fixed, tied and log require at most {} unknowns, got {}",
                         int{Trace::ModelAnswer::kUnknowns}, model->names.size());
    });
    trace_.model_answer.unknowns = static_cast<int>(model->names.size());
  }
  const problems::Bounds* const bounds = own.bounds         ? &*own.bounds
                                         : model != nullptr ? nullptr
                                                            : problem_.bounds();
  kept.is_bounded = bounds != nullptr;
  if (bounds == nullptr) return;
  std::ranges::copy(bounds->lower, kept.lower);
  std::ranges::copy(bounds->upper, kept.upper);
}

void Meter::keep_returned() {
  Trace::Answer& kept = trace_.answer;
  if (kept.unknowns == 0) return;
  std::copy_n(judged_theta_.data(), kept.unknowns, kept.returned);
  if (trace_.model_answer.unknowns > 0)
    std::ranges::copy(problem_.in_own_units(judged_theta_), trace_.model_answer.returned);
  kept.residual_norm = (judged_.y - problem_.target()).norm();
  kept.has_returned = true;
  keep_fit();
}

void Meter::keep_model_best() {
  const Trace::Answer& kept = trace_.answer;
  if (trace_.model_answer.unknowns == 0 || !kept.has_best) return;
  const Eigen::Map<const Vector> theta(kept.best, kept.unknowns);
  std::ranges::copy(problem_.in_own_units(theta), trace_.model_answer.best);
}

// The data and y of a user's own program, or of a problem with the words of a model.
void Meter::keep_fit() {
  Trace::Fit& kept = trace_.fit;
  const problems::Model* const model = problem_.model();
  const Index m = problem_.residuals() - problem_.penalties();
  if ((!problem_.is_elsewhere() && !model) || !problem_.is_least_squares() ||
      problem_.samples() != 1 || m > Trace::Fit::kData)
    return;
  const bool has_factors = model && model->factors.size() == m;
  kept.has_sigma = has_factors && problem_.noise_level().has_value();
  for (Index i = 0; i < m; ++i) {
    const Real unit = has_factors ? 1 / model->factors[i] : 1;
    kept.sigma[i] = unit;
    kept.target[i] = unit * problem_.target()(i, 0);
    kept.y[i] = unit * judged_.y(i, 0);
  }
  kept.data = static_cast<int>(m);
}

// At the returned point, where x is the unknown; those that a bound holds are constants, and have
// none. By the singular values of A = J D⁻¹, D the norms
// of J's columns: (JᵀJ)⁻¹ = D⁻¹ V Σ⁻² Vᵀ D⁻¹, without the squares of their condition number. Where
// J does not have full rank, x has no such covariance.
void Meter::keep_uncertainty() {
  Trace::Uncertainty& kept = trace_.uncertainty;
  const Index m = problem_.residuals(), all = problem_.unknowns();
  if (!problem_.is_least_squares() || problem_.is_learned() || !problem_.has_identity_network() ||
      problem_.samples() != 1 || m <= all || all > Trace::Uncertainty::kUnknowns ||
      !std::isfinite(judged_.loss))
    return;
  const bool is_known = are_same(known_theta_, judged_theta_);
  if (!problem_.offers().contains(Oracle::jacobian) && !is_known) return;
  if (!know_jacobian_at_end()) {
    if (trace_.message[0] == '\0')
      set_text(trace_.message, "no calls were left for standard deviations");
    return;
  }
  const Vector slope = known_J_.transpose() * (judged_.y - problem_.target()).reshaped();
  std::vector<Index> free;
  for (Index i = 0; i < all; ++i)
    if (!is_held(i, slope)) free.push_back(i);
  const auto n = static_cast<Index>(free.size());
  if (n == 0) return;
  const Matrix J = known_J_(Eigen::all, free);  // (m, n)
  const Vector D = J.colwise().norm();          // (n)
  Svd svd;
  if (!is_finite(J) || !(D.minCoeff() > 0) || !thin_svd(J * D.cwiseInverse().asDiagonal(), svd))
    return;
  const Vector& sigma = svd.sigma;
  if (!(sigma[n - 1] > static_cast<Real>(m) * std::numeric_limits<Real>::epsilon() * sigma[0]))
    return;
  Matrix root = svd.Vt.transpose() * sigma.cwiseInverse().asDiagonal();  // A's, (n, n)
  const Vector lengths = root.rowwise().norm();
  root.array().colwise() /= lengths.array();
  kept.degrees_of_freedom = m - n;
  kept.variance = (judged_.y - problem_.target()).squaredNorm() / static_cast<Real>(m - n);
  kept.condition = sigma[0] / sigma[n - 1];
  const Matrix correlation = root * root.transpose();
  const Vector x = problem_.in_own_units(judged_theta_);
  const problems::OwnUnits& own = problem_.own_units();
  const Index k = x.size();
  if (k > Trace::Uncertainty::kUnknowns) return;
  std::ranges::copy(x, kept.x);
  kept.unknowns = static_cast<int>(k);
  for (Index i = 0; i < k; ++i) {
    kept.deviation[i] = std::nan("");
    for (Index j = 0; j < k; ++j) kept.correlation[i][j] = i == j ? 1 : std::nan("");
  }
  if (problem_.model() != nullptr) {  // C = S C_θ Sᵀ
    const Vector deviations = std::sqrt(kept.variance) * lengths.array() / D.array();
    const Matrix S =
        Matrix(problem_.model_slopes(judged_theta_)(Eigen::all, free)) * deviations.asDiagonal();
    const Matrix C = S * correlation * S.transpose();
    for (Index i = 0; i < k; ++i) {
      if (!(C(i, i) > 0)) continue;
      kept.deviation[i] = std::sqrt(C(i, i));
      for (Index j = 0; j < k; ++j)
        if (i != j && C(j, j) > 0) kept.correlation[i][j] = C(i, j) / std::sqrt(C(i, i) * C(j, j));
    }
    return;
  }
  for (Index l = 0; l < n; ++l) {
    const Index i = free[static_cast<std::size_t>(l)];
    const Real scale = own.scales.size() > 0 ? own.scales[i] : 1;
    kept.deviation[i] = scale * std::sqrt(kept.variance) * lengths[l] / D[l];
    for (Index o = 0; o < n; ++o)
      if (l != o)
        kept.correlation[i][free[static_cast<std::size_t>(o)]] =
            correlation(std::max(l, o), std::min(l, o));
  }
}

Real Meter::residual_unit() const {
  const Real length = std::sqrt(2 * trace_.start_loss);
  const bool is_scaled =
      (problem_.own_units().scales.size() > 0 || problem_.model() != nullptr) && length > 0;
  return is_scaled && std::isfinite(length) ? std::exp2(-std::round(std::log2(length))) : 1;
}

bool Meter::is_held(Index i, VectorRef slope) const {
  const Bounds* const bounds = problem_.bounds();
  return bounds != nullptr &&
         (bounds->is_active(judged_theta_, slope, i) || bounds->lower[i] == bounds->upper[i]);
}

const Problem& Linearization::ask(Oracle oracle) {
  meter_->charge(oracle);
  if (meter_->are_products_at_once_)
    meter_->share_rounds(meter_->prices_[static_cast<std::size_t>(oracle)]);
  return meter_->problem_;
}

const Matrix& Linearization::once(Oracle oracle, bool& is_there, Matrix& out) {
  if (is_there) return out;
  const Problem& problem = ask(oracle);
  oracle == Oracle::jacobian ? problem.jacobian(out, point_) : problem.hessian(out, point_);
  is_there = true;
  return out;
}

void Linearization::gradient(Vector& out) {
  cotangent(g_);
  out.resize(problem_->unknowns());
  pullback(g_, out);
}

}  // namespace isoline::optimizers
