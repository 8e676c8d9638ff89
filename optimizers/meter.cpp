// The meter: what a method may ask, counted.
#include "optimizers/meter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/ladder.h"

namespace isoline::optimizers {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
constexpr Real kNone = -kInfinity;  // a loss that is never reached
}  // namespace

Meter::Meter(const Problem& problem, const Budget& budget, OracleSet granted, Trace& trace)
    : problem_(problem),
      budget_(budget),
      granted_(granted),
      trace_(trace),
      samples_(&problem.batch()),
      prices_(problem.prices()),
      best_loss_(kInfinity),
      next_target_(kNone),
      target_loss_(kNone),
      stall_loss_(std::numeric_limits<Real>::max()) {
  trace_.prices = prices_;
  trace_.is_learned = problem.is_learned();
  name_series({});
  trace_.aim = problem.aim();
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
  problem_.forward(theta, *samples_, at.point_);
  see(at.point_.loss);
  if (problem_.is_learned() && !has_seen_batch_) note_batch(at.point_);
}

void Meter::linearize_physics(BatchRef x, Linearization& at) {
  charge(Oracle::forward);
  at.meter_ = this;
  at.has_jacobian_ = at.has_hessian_ = false;
  problem_.physics_forward(x, *samples_, at.point_);
}

const Matrix& Meter::truth() {
  charge(Oracle::truth);
  return samples_->truth;
}

Real Meter::loss(VectorRef theta) {
  charge(Oracle::forward);
  problem_.forward(theta, *samples_, point_);
  see(point_.loss);
  return point_.loss;
}

void Meter::refuse(Oracle oracle) const {
  throw std::logic_error(
      fmt::format("the method asked for the oracle '{}', which it does not declare that it needs",
                  name_of(oracle)));
}

void Meter::claim(std::string_view words) { set_text(trace_.claimed, words); }

void Meter::name_series(const std::vector<std::string>& names) {
  std::vector<std::string> all = problem_.series().names;
  all.insert(all.end(), names.begin(), names.end());
  const std::string text = fmt::format("{}", fmt::join(all, "\n"));
  require(all.size() <= Trace::kSeries && text.size() < Trace::kText,
          "there are more series than there is room for");
  set_text(trace_.series_names, text);
}

void Meter::note(std::size_t which, Real value) {
  trace_.last.series[problem_.series().names.size() + which] = value;
}

void Meter::reach(Real loss) {
  if (!std::isfinite(loss)) return;
  while (targets_met_ < kRungs) {
    next_target_ = target_at(rung(static_cast<std::size_t>(targets_met_)));
    if (!(loss <= next_target_)) return;
    TraceHit& hit = trace_.hit[targets_met_++];
    hit.work = work_;
    hit.counts = counts_;
    hit.wall_seconds = watch_.seconds();
    hit.iteration = iteration_;
  }
  next_target_ = kNone;
}

}  // namespace isoline::optimizers
