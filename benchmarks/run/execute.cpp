// The run loop; its checkpoints, which are written whole and read only by the same cell and build;
// and the record of the data in its trace.
#include "benchmarks/run/execute.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <functional>
#include <limits>
#include <new>
#include <utility>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/rates.h"
#include "benchmarks/run/keepers/keeper.h"
#include "benchmarks/run/store.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/failures.h"
#include "core/files.h"
#include "core/foreign/handshake.h"
#include "core/foreign/line.h"
#include "core/random.h"
#include "core/records/provenance.h"
#include "core/records/record.h"
#include "core/status.h"
#include "core/text.h"
#include "problems/features.h"

namespace isoline::benchmarks {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

// In the message of a run: how many evaluations failed, and the first of them.
void note_failures(Trace& trace) {
  const FailedEvaluations& failed = trace.failures;
  if (failed.total == 0 || (trace.message[0] != '\0' && trace.status != Status::unconfirmed))
    return;
  const std::string before = trace.message[0] == '\0' ? "" : std::string(trace.message) + "; ";
  constexpr std::size_t kShown = 8;
  const std::span<const double> x = failed.point(0);
  set_text(trace.message,
           fmt::format("{}{} evaluation{} failed, the first{}{:.10g}{}: {}", before, failed.total,
                       failed.total == 1 ? "" : "s", x.empty() ? "" : " at x = (",
                       fmt::join(x.first(std::min(x.size(), kShown)), ", "),
                       x.empty()           ? ""
                       : x.size() > kShown ? ", …)"
                                           : ")",
                       failed.reason[0]));
}

void run(const Catalog& catalog, const Request& request, Trace& trace, Checkpoint& checkpoint,
         Vector* returned, int perturbation) {
  const CallSink calls(trace.calls);
  const Problem problem = make_for_methods(catalog, request.problem, request.seed);
  const OptimizerEntry& entry = catalog.optimizers.at(request.optimizer.name);
  const std::string reason = why_inapplicable(entry, request.optimizer.options, problem);
  if (!reason.empty()) throw NotApplicable(reason);
  const auto method = entry.make(request.optimizer.options, catalog.optimizers);
  require_unedited(request.problem.foreign);
  require_unedited(request.optimizer.foreign);
  const OracleSet granted = needs_of(entry, request.optimizer.options, problem);
  const auto privileges = optimizers::privileges_of(granted, problem.inverse_kind());
  set_text(trace.privileges, fmt::format("{}", fmt::join(privileges, "\n")));
  Meter meter(problem, request.budget, granted, trace, open_keepers(trace));
  Vector start = problem.start();
  if (returned && returned->size() > 0) start = *returned;
  if (perturbation != 0) start = perturbed_start(std::move(start), request, perturbation);
  checkpoint.watch(trace, request.budget);
  const FailureSink sink(trace.failures);
  const Vector theta = drive(*method, meter, std::move(start), checkpoint);
  note_failures(trace);
  if (trace.status == Status::budget && !trace.stopped_by_clock) checkpoint.keep_end();
  if (returned) *returned = theta;
}

// --- the record of a run from its trace

// One number of each point of the trace.
template <class Value>
auto column_of(const Trace& trace, Value value) {
  std::vector<std::decay_t<std::invoke_result_t<Value, const TracePoint&>>> column;
  for (int i = 0; i < trace.points; ++i) column.push_back(std::invoke(value, trace.point[i]));
  return column;
}

// amounts(i) by each number of workers, kWorkers[i].
std::map<std::string, std::vector<std::int64_t>> rounds_of(const Trace& trace, auto amounts) {
  std::map<std::string, std::vector<std::int64_t>> rounds;
  for (std::size_t i = 0; trace.counts_rounds && i < kWorkers.size(); ++i)
    rounds[std::to_string(kWorkers[i])] = amounts(i);
  return rounds;
}

std::map<std::string, std::vector<Real>> series_of(const Trace& trace) {
  std::map<std::string, std::vector<Real>> series;
  const std::vector<std::string> names = lines_of(trace.series_names);
  for (std::size_t i = 0; i < names.size(); ++i)  // two names that were no text may be one now
    series[names[i]] = column_of(trace, [i](const TracePoint& point) { return point.series[i]; });
  return series;
}

Curve curve_of(const Trace& trace) {
  Curve curve;
  curve.iteration = column_of(trace, &TracePoint::iteration);
  curve.work = column_of(trace, &TracePoint::work);
  curve.wall_seconds = column_of(trace, &TracePoint::wall_seconds);
  curve.processor_seconds = column_of(trace, &TracePoint::processor_seconds);
  curve.loss = column_of(trace, &TracePoint::loss);
  curve.x_error = column_of(trace, &TracePoint::x_error);
  curve.gradient_norm = column_of(trace, &TracePoint::gradient_norm);
  curve.step_norm = column_of(trace, &TracePoint::step_norm);
  if (trace.is_bounded) curve.kkt_residual = column_of(trace, &TracePoint::kkt_residual);
  if (std::isfinite(trace.noise_level))
    curve.discrepancy = column_of(trace, &TracePoint::discrepancy);
  for (std::size_t i = 0; trace.is_learned && i < 2; ++i) {
    const std::int64_t window = TracePoint::kWindows[i];
    curve.batch_loss[window] =
        column_of(trace, [i](const TracePoint& point) { return point.batch_loss[i]; });
    curve.batch_x_error[window] =
        column_of(trace, [i](const TracePoint& point) { return point.batch_x_error[i]; });
  }
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    auto column = column_of(trace, [=](const TracePoint& point) { return point.counts[kind]; });
    if (!column.empty() && column.back() > 0)
      curve.counts[std::string(kOracleNames[kind])] = std::move(column);
  }
  curve.rounds = rounds_of(trace, [&](std::size_t i) {
    return column_of(trace, [i](const TracePoint& point) { return point.rounds[i]; });
  });
  return curve;
}

Hits hits_of(const Trace& trace, const TraceHit (&reached)[kRungs]) {
  Hits hits;
  for (std::size_t j = 0; j < kRungs; ++j) {
    const TraceHit& hit = reached[j];
    const bool is_met = hit.iteration >= 0;
    hits.target.push_back(rung(j));
    hits.iteration.push_back(hit.iteration);
    hits.work.push_back(is_met ? hit.work : -1);
    hits.forwards.push_back(is_met ? hit.counts[0] : -1);
    hits.wall_seconds.push_back(is_met ? hit.wall_seconds : std::nan(""));
  }
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    std::vector<std::int64_t> column;
    for (const TraceHit& hit : reached)
      column.push_back(hit.iteration >= 0 ? hit.counts[kind] : -1);
    const bool is_asked = trace.last.counts[kind] > 0 || std::ranges::max(column) > 0;
    if (is_asked) hits.counts[std::string(kOracleNames[kind])] = std::move(column);
  }
  hits.rounds = rounds_of(trace, [&](std::size_t i) {
    std::vector<std::int64_t> column;
    for (const TraceHit& hit : reached) column.push_back(hit.iteration >= 0 ? hit.rounds[i] : -1);
    return column;
  });
  return hits;
}

Summary summary_of(const Trace& trace) {
  const TracePoint& last = trace.last;
  const bool has_points = trace.points > 0;
  return {.iterations = last.iteration,
          .work = last.work,
          .rejected_steps = trace.rejected_steps,
          .start_loss = trace.start_loss,
          .loss = has_points ? last.loss : std::nan(""),
          .best_loss = trace.best_loss,
          .start_x_error = trace.start_x_error,
          .x_error = has_points ? last.x_error : std::nan(""),
          .gradient_norm = has_points ? last.gradient_norm : std::nan(""),
          .wall_seconds = last.wall_seconds,
          .processor_seconds = last.processor_seconds,
          .peak_memory_bytes = trace.peak_memory_bytes};
}

// The success criterion of the run, and its result at the returned point: f ≤ f_L + τ s, or the
// error in x. A run that broke off did not return a point.
void add_verdicts(const Trace& trace, Record& record) {
  const auto known = [](Real value) {
    return std::isnan(value) ? std::nullopt : std::optional(value);
  };
  const bool has_returned = !is_failure(trace.status) && trace.points > 0;
  const auto meets = [&](Real value, Real goal) {  // infinity ≤ infinity is not a success
    return has_returned && std::isfinite(value) && std::isfinite(goal) && value <= goal;
  };
  record.aim = trace.aim;
  record.minimum = known(trace.minimum);
  record.scale = known(trace.scale);
  record.x_scale = known(trace.x_scale);
  record.x_floor = trace.x_floor;
  record.noise_level = known(trace.noise_level);
  for (const auto& [name, tau] : kVerified) {
    auto &verified = record.verified[name], &found = record.found[name];
    if (record.minimum) verified = meets(trace.last.loss, trace.minimum + tau * trace.scale);
    if (record.x_scale)
      found = meets(trace.last.x_error, x_goal(tau, trace.x_scale, trace.x_floor));
  }
}

std::string heading_of(const std::string& identity) {
  return "isoline.checkpoint/2 " + identity + "\n";
}

}  // namespace

Checkpoint::Checkpoint(std::filesystem::path path, std::string identity, double every_seconds)
    : path_(std::move(path)),
      identity_(heading_of(identity)),
      every_seconds_(every_seconds),
      last_nanoseconds_(monotonic_nanoseconds()) {
  stop_requested = 0;
  std::signal(SIGTERM, [](int) { stop_requested = 1; });
}

bool Checkpoint::restore(Optimizer& method, Meter& meter, Vector& theta) {
  const std::string of_end = heading_of(ends_.stem.filename().string());
  if (!restore_from(path_, identity_, method, meter, theta) &&
      !restore_from(ends_.from, of_end, method, meter, theta))
    return false;
  if (trace_) noted_ = trace_->last.iteration;
  return true;
}

bool Checkpoint::restore_from(const std::filesystem::path& path, const std::string& identity,
                              Optimizer& method, Meter& meter, Vector& theta) {
  constexpr std::size_t kDigits = 16;  // of the digest before the state
  if (path.empty()) return false;
  std::string bytes;
  try {
    bytes = read_text(path);
  } catch (const UsageError&) {
    return false;
  }
  if (!bytes.starts_with(identity)) return false;
  const std::string sum = bytes.substr(identity.size(), kDigits);
  bytes.erase(0, identity.size() + kDigits);
  if (sum != digest(bytes)) return false;
  try {
    Archive archive(std::move(bytes));
    method.start(meter, theta);
    archive(theta);
    require(theta.size() == meter.unknowns(), "it has another number of unknowns");
    require(method.persist(archive), "the method does not store its state");
    meter.persist(archive);
    const std::string defect = defect_of_all(meter.trace());
    require(meter.trace().has_kept && defect.empty(), [&] { return "its trace holds " + defect; });
    require(archive.bytes_left() == 0, "it contains more than the state of this run");
  } catch (const std::exception& cause) {
    std::error_code error;
    std::filesystem::rename(path, path.string() + ".damaged", error);
    if (error) {  // nor is it read again, or written over
      path_.clear();
      ends_ = {};
    }
    throw DamagedCheckpoint(cause.what());
  }
  return true;
}

bool Checkpoint::save_if_due(Optimizer& method, Meter& meter, Vector& theta) {
  note_end(method, meter, theta);
  if (path_.empty()) return false;
  const std::int64_t now = monotonic_nanoseconds();
  const bool is_due = 1e-9 * static_cast<double>(now - last_nanoseconds_) >= every_seconds_;
  if (!is_due && !stop_requested) return false;
  last_nanoseconds_ = now;
  Archive archive;
  archive(theta);
  if (!method.persist(archive)) return stop_requested != 0;
  meter.persist(archive);
  try {
    write_text(path_, identity_ + digest(archive.bytes()) + archive.bytes());
  } catch (const std::exception&) {  // if the disk is full, the run continues without a checkpoint
  }
  return stop_requested != 0;
}

// A budget may cut its last step short, so that the state at the end is not that of a longer run.
// The states that are noted are those of kept iterations, where the trace states what was spent.
void Checkpoint::note_end(Optimizer& method, Meter& meter, Vector& theta) {
  if (ends_.stem.empty() || trace_->last.iteration == noted_) return;
  const TracePoint& last = trace_->last;
  noted_ = last.iteration;
  const bool is_late = 2 * last.iteration >= budget_->iterations || last.work >= budget_->work / 2;
  if (!is_late || last.wall_seconds < ends_.least_seconds) return;
  Archive archive;
  archive(theta);
  if (!method.persist(archive)) return;
  meter.persist(archive);
  end_ = archive.bytes();
  // Then another forward solve is left, and for a direct problem one of the returned point.
  const std::int64_t forward = trace_->prices[static_cast<std::size_t>(Oracle::forward)];
  needed_ = {.iterations = last.iteration + 1,
             .work = last.work + (trace_->is_learned ? 1 : 2) * forward};
}

void Checkpoint::keep_end() {
  if (end_.empty()) return;
  const auto path = Store::end_path(ends_.stem, needed_);
  try {
    write_text(path, heading_of(ends_.stem.filename().string()) + digest(end_) + end_);
    std::error_code error;
    if (path != ends_.from) std::filesystem::remove(ends_.from, error);  // this one is later
  } catch (const std::exception&) {  // a full disk: a larger budget starts from the beginning
  }
}

Vector perturbed_start(Vector start, const Request& request, int number) {
  constexpr Real kUnit = std::numeric_limits<Real>::epsilon();  // of 1
  constexpr Real kAbove = std::numeric_limits<Real>::infinity();
  const Real largest = start.size() > 0 ? start.cwiseAbs().maxCoeff() : 0;
  const Real of_zero = kUnit * (largest > 0 ? largest : 1);
  Vector signs(start.size());
  RandomStream(request.seed, request.problem.name, "last bit", static_cast<std::uint64_t>(number))
      .signs(signs);
  for (Index i = 0; i < start.size(); ++i)
    start[i] = start[i] == 0 ? signs[i] * of_zero : std::nextafter(start[i], signs[i] * kAbove);
  return start;
}

namespace {

// Retreats from points whose evaluation fails, where a method cannot go on: it starts again halfway
// back to the last point with a value, until one has a value.
class Retreat {
 public:
  // `origin`: where the last step began in which no evaluation failed.
  Retreat(const FailedEvaluations& failures, const Vector& start, Vector& origin)
      : failures_(failures), origin_(origin), seen_(failures.total) {
    if (origin_.size() != start.size()) origin_ = start;
  }

  // After a step from `before`. True if the method must start again at θ.
  bool is_due(const Vector& before, Vector& theta, Status& verdict) {
    const bool has_failed = has_new_failures(), was_failed = std::exchange(is_at_failed_, false);
    if (!has_failed && !was_failed) {
      origin_ = before;
      return false;
    }
    const bool is_lost = !theta.allFinite() || verdict == Status::diverged;
    if (!is_lost && !(was_failed && verdict != Status::running)) return false;
    theta = 0.5 * (origin_ + before);
    verdict = Status::running;
    if (theta != before && theta != origin_) return true;
    theta = origin_;  // at the edge of what fails, where each step fails
    verdict = Status::stalled;
    return false;
  }
  // After an iteration that ended at θ. A method that evaluates other points alone may go on from a
  // failed one. The harness does not judge each θ: `seen` is the last that it did.
  Status excused(const Vector& theta, const Vector& seen, Status judged) {
    const bool has_failed = has_new_failures() || (failed_.size() > 0 && seen == failed_);
    const bool is_excused = has_failed && judged == Status::diverged && theta.allFinite();
    if (is_excused) failed_ = seen;
    is_at_failed_ = is_excused && theta == seen;
    return is_excused ? Status::running : judged;
  }
  bool is_at_failed() const { return is_at_failed_; }

 private:
  bool has_new_failures() { return std::exchange(seen_, failures_.total) < failures_.total; }

  const FailedEvaluations& failures_;
  Vector& origin_;  // (n)
  Vector failed_;   // (n), the last point that the harness judged in vain
  std::int64_t seen_;
  bool is_at_failed_ = false;
};

}  // namespace

Vector drive(Optimizer& method, Meter& meter, Vector theta, Checkpoint& checkpoint) {
  Status verdict = Status::running;
  Vector before;  // (n), where the step began
  try {
    if (!checkpoint.restore(method, meter, theta)) {
      before = theta;
      verdict = meter.begin(theta);
      if (verdict == Status::running) method.start(meter, theta);
    }
    Retreat retreat(meter.failures(), theta, meter.origin());
    while (verdict == Status::running) {
      before = theta;
      verdict = method.step(meter, theta);
      if (theta.size() != meter.unknowns())  // else the harness would read beyond the array
        throw std::runtime_error(fmt::format(
            "the method changed the number of unknowns from {} to {}, which a step must not do",
            meter.unknowns(), theta.size()));
      if (method.reports_iterations()) break;
      const bool starts_again = retreat.is_due(before, theta, verdict);
      const Status status = meter.iterate(theta);
      Status judged = retreat.excused(theta, meter.judged(), status);
      if (judged != status) judged = meter.limit();
      if (judged != Status::running) verdict = judged;
      if (verdict == Status::running && starts_again) method.start(meter, theta);
      if (verdict == Status::running && !retreat.is_at_failed() &&
          checkpoint.save_if_due(method, meter, theta))
        return theta;
    }
  } catch (const optimizers::BudgetSpent&) {  // during a step
    theta = before;
    verdict = Status::budget;
  } catch (const CallsFailed& error) {  // the run ends at the best point, if it has any
    const Trace& trace = meter.trace();
    if (!trace.has_best || trace.unknowns != theta.size()) throw;
    theta = Eigen::Map<const Vector>(trace.best, trace.unknowns);
    verdict = Status::failed;
    meter.remark(error.what());
  }
  return meter.finish(theta, verdict);
}

void execute(const Catalog& catalog, const Request& request, Trace& trace, Checkpoint checkpoint,
             Vector* returned, int perturbation) {
  const auto conclude = [&](Status status, std::string_view message) {
    trace.status = status;
    set_text(trace.message, message);
  };
  try {
    try {
      run(catalog, request, trace, checkpoint, returned, perturbation);
    } catch (const DamagedCheckpoint&) {  // the checkpoint is set aside, and the run starts again
      const bool wants_spectra = trace.wants_spectra;
      new (&trace) Trace;
      trace.wants_spectra = wants_spectra;
      run(catalog, request, trace, checkpoint, returned, perturbation);
    }
    if (trace.status == Status::running)
      conclude(Status::interrupted, "the run was stopped, and saved its state");
  } catch (const NotApplicable& reason) {
    conclude(Status::inapplicable, reason.what());
  } catch (const std::bad_alloc&) {
    conclude(Status::memory, "the cell exceeded its memory limit");
  } catch (const KilledProgram& error) {
    conclude(Status::interrupted, error.what());
  } catch (const std::exception& error) {
    conclude(Status::failed, error.what());
  } catch (...) {
    conclude(Status::failed, "threw an object that is not a std::exception");
  }
}

Record record_of(const Request& request, const Trace& trace) {
  Record record;
  record.request = request;
  require(!request.cell.empty(), "the request does not state the ID of its cell");
  record.cell = request.cell;
  record.build = build_digest(request);
  record.build_parts = build_parts(request);
  record.status = trace.status == Status::running ? Status::interrupted : trace.status;
  record.message = valid_utf8(trace.message);
  record.claimed = valid_utf8(trace.claimed);
  add_verdicts(trace, record);
  record.counts = trace.last.counts;
  record.prices = trace.prices;
  const std::optional<Real> best = BestLosses::known().find(request.problem, request.seed);
  record.is_best_known = record.minimum && (best == record.minimum ||
                                            problems::has_fitted_minimum(request.problem.options));
  record.criterion = digest_of(criterion_of(record));
  record.summary = summary_of(trace);
  record.curve = curve_of(trace);
  if (record.minimum) record.hits = hits_of(trace, trace.hit);
  if (record.x_scale && record.aim == Aim::x && !trace.is_learned)
    record.x_hits = hits_of(trace, trace.x_hit);
  record.series = series_of(trace);
  write_parts(trace, record);
  record.privileges = lines_of(trace.privileges);
  record.foreign = {request.problem.foreign, request.optimizer.foreign};
  record.is_nondeterministic = trace.stopped_by_clock || record.status == Status::timeout ||
                               record.status == Status::interrupted ||
                               record.status == Status::memory;
  if (trace.is_finished) record.repeat_wall_seconds = {trace.last.wall_seconds};
  record.provenance.build = this_build();
  return record;
}

}  // namespace isoline::benchmarks
