// The record of a run from its trace, which is sound (core/trace.h says what that is).
#include <algorithm>
#include <cmath>
#include <sstream>

#include "benchmarks/plan/build_parts.h"
#include "benchmarks/plan/rates.h"
#include "benchmarks/run/execute.h"
#include "core/files.h"
#include "core/frames.h"
#include "core/records/provenance.h"
#include "core/records/record.h"
#include "core/status.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

std::vector<std::string> lines_of(const char* text) {
  std::vector<std::string> lines;
  std::istringstream in(valid_utf8(text));
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// The parts of a trace that only learning problems and problems with series have.
void add_training_columns(const Trace& trace, Curve& curve) {
  const auto column = [&](auto&& value) {
    std::vector<Real> values;
    for (int i = 0; i < trace.points; ++i) values.push_back(value(trace.point[i]));
    return values;
  };
  if (!trace.is_learned) return;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::int64_t window = TracePoint::kWindows[i];
    curve.batch_loss[window] = column([i](const TracePoint& point) { return point.batch_loss[i]; });
    curve.batch_x_error[window] =
        column([i](const TracePoint& point) { return point.batch_x_error[i]; });
  }
}

std::map<std::string, std::vector<Real>> series_of(const Trace& trace) {
  std::map<std::string, std::vector<Real>> series;
  const std::vector<std::string> names = lines_of(trace.series_names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<Real>& values = series[names[i]];
    values.clear();  // two names that were no text may have become one
    for (int p = 0; p < trace.points; ++p) values.push_back(trace.point[p].series[i]);
  }
  return series;
}

Grid grid_of(const Trace::Exhibit& shown) {
  return {
      shown.rows, shown.columns, {shown.value, shown.value + Index{shown.rows} * shown.columns}};
}

std::optional<Exhibit> exhibit_of(const Trace& trace) {
  if (trace.shown_x.rows == 0) return std::nullopt;
  return Exhibit{.target = grid_of(trace.shown_target),
                 .x = grid_of(trace.shown_x),
                 .truth = grid_of(trace.shown_truth)};
}

// A field stands column by column, a file holds rows.
void add_rows(const float* field, Index rows, Index columns, std::vector<float>& out) {
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) out.push_back(field[j * rows + i]);
}

std::optional<FieldFrames> fields_of(const Trace& trace) {
  const Trace::Frames& kept = trace.frames;
  const std::vector<std::size_t> chosen = chosen_frames(kept);
  if (kept.rows == 0 || chosen.empty()) return std::nullopt;
  FieldFrames frames;
  add_rows(kept.target, kept.rows, kept.columns, frames.numbers);
  if (kept.has_truth) add_rows(kept.truth, kept.rows, kept.columns, frames.numbers);
  for (const std::size_t place : chosen) {
    frames.iterations.push_back(kept.iteration[place]);
    add_rows(kept.x[place], kept.rows, kept.columns, frames.numbers);
  }
  const auto cells = static_cast<std::size_t>(kept.rows) * static_cast<std::size_t>(kept.columns);
  frames.shape = {static_cast<Index>(frames.numbers.size() / cells), kept.rows, kept.columns};
  frames.digest = digest(field_file(frames));
  return frames;
}

std::optional<Spectrum> spectrum_of(const Trace& trace) {
  const Trace::Spectra& kept = trace.spectra;
  if (!kept.are_wanted) return std::nullopt;
  Spectrum spectrum;
  for (int i = 0; i < kept.taken; ++i) {
    spectrum.iterations.push_back(kept.iteration[i]);
    spectrum.sigma.emplace_back(kept.sigma[i], kept.sigma[i] + kept.values);
  }
  return spectrum;
}

Curve curve_of(const Trace& trace) {
  Curve curve;
  const int points = trace.points;
  for (int i = 0; i < points; ++i) {
    const TracePoint& point = trace.point[i];
    curve.iteration.push_back(point.iteration);
    curve.work.push_back(point.work);
    curve.wall_seconds.push_back(point.wall_seconds);
    curve.processor_seconds.push_back(point.processor_seconds);
    curve.loss.push_back(point.loss);
    curve.x_error.push_back(point.x_error);
    curve.gradient_norm.push_back(point.gradient_norm);
    curve.step_norm.push_back(point.step_norm);
  }
  add_training_columns(trace, curve);
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    std::vector<std::int64_t> column;
    for (int i = 0; i < points; ++i) column.push_back(trace.point[i].counts[kind]);
    if (!column.empty() && column.back() > 0)
      curve.counts[std::string(kOracleNames[kind])] = column;
  }
  return curve;
}

Hits hits_of(const Trace& trace) {
  Hits hits;
  for (std::size_t j = 0; j < kRungs; ++j) {
    const TraceHit& hit = trace.hit[j];
    const bool is_met = hit.iteration >= 0;
    hits.target.push_back(rung(j));
    hits.iteration.push_back(hit.iteration);
    hits.work.push_back(is_met ? hit.work : -1);
    hits.forwards.push_back(is_met ? hit.counts[0] : -1);
    hits.wall_seconds.push_back(is_met ? hit.wall_seconds : std::nan(""));
  }
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    std::vector<std::int64_t> column;
    for (const TraceHit& hit : trace.hit)
      column.push_back(hit.iteration >= 0 ? hit.counts[kind] : -1);
    const bool is_asked = trace.last.counts[kind] > 0 || std::ranges::max(column) > 0;
    if (is_asked) hits.counts[std::string(kOracleNames[kind])] = std::move(column);
  }
  return hits;
}

Trajectory trajectory_of(const Trace& trace) {
  Trajectory path;
  const int points = trace.points;
  for (int i = 0; i < points; ++i) {
    path.x.emplace_back(trace.path_x[i], trace.path_x[i] + trace.path_inputs);
    path.y.emplace_back(trace.path_y[i], trace.path_y[i] + trace.path_outputs);
  }
  return path;
}

Summary summary_of(const Trace& trace) {
  const TracePoint& last = trace.last;
  return {.iterations = last.iteration,
          .work = last.work,
          .rejected_steps = trace.rejected_steps,
          .start_loss = trace.start_loss,
          .loss = trace.points > 0 ? last.loss : std::nan(""),
          .best_loss = trace.best_loss,
          .start_x_error = trace.start_x_error,
          .x_error = trace.points > 0 ? last.x_error : std::nan(""),
          .gradient_norm = trace.points > 0 ? last.gradient_norm : std::nan(""),
          .wall_seconds = last.wall_seconds,
          .processor_seconds = last.processor_seconds,
          .peak_memory_bytes = trace.peak_memory_bytes};
}

bool has_returned(const Trace& trace) { return !is_failure(trace.status) && trace.points > 0; }

// Infinity at most infinity says nothing.
bool is_at_most(Real value, Real goal) {
  return std::isfinite(value) && std::isfinite(goal) && value <= goal;
}

// f ≤ f_L + τ s at the returned point; a run that broke off returned none.
std::optional<bool> is_verified(const Trace& trace, Real tau) {
  if (std::isnan(trace.minimum)) return std::nullopt;
  return has_returned(trace) && is_at_most(trace.last.loss, trace.minimum + tau * trace.scale);
}

std::optional<bool> is_found(const Trace& trace, Real tau) {
  if (std::isnan(trace.x_scale)) return std::nullopt;
  return has_returned(trace) &&
         is_at_most(trace.last.x_error, x_goal(tau, trace.x_scale, trace.x_floor));
}

// The criterion of the run, and its result.
void add_verdicts(const Trace& trace, Record& record) {
  const auto known = [](Real value) {
    return std::isnan(value) ? std::nullopt : std::optional(value);
  };
  record.aim = trace.aim;
  record.minimum = known(trace.minimum);
  record.scale = known(trace.scale);
  record.x_scale = known(trace.x_scale);
  record.x_floor = trace.x_floor;
  for (const auto& [name, tau] : kVerified) {
    record.verified[name] = is_verified(trace, tau);
    record.found[name] = is_found(trace, tau);
  }
}

}  // namespace

Record record_of(const Request& request, const Trace& trace) {
  Record record;
  record.request = request;
  require(!request.cell.empty(), "a request is run without the name of its cell");
  record.cell = request.cell;
  record.build = build_digest(request);
  record.build_parts = build_parts(request);
  record.status = trace.status == Status::running ? Status::interrupted : trace.status;
  record.message = valid_utf8(trace.message);
  record.claimed = valid_utf8(trace.claimed);
  add_verdicts(trace, record);
  record.counts = trace.last.counts;
  record.prices = trace.prices;
  const std::optional<Real> best = BestLosses::builtin().find(request.problem, request.seed);
  record.is_best_known = best && best == record.minimum;
  record.criterion = digest_of(criterion_of(record));
  record.summary = summary_of(trace);
  record.curve = curve_of(trace);
  if (record.minimum) record.hits = hits_of(trace);
  if (trace.path_inputs > 0) record.trajectory = trajectory_of(trace);
  record.series = series_of(trace);
  record.exhibit = exhibit_of(trace);
  record.fields = fields_of(trace);
  record.spectrum = spectrum_of(trace);
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
