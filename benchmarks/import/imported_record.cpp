// Makes a record of a foreign curve, point by point as the meter would have kept it.
#include "benchmarks/import/imported_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/digest.h"
#include "core/errors.h"
#include "core/ladder.h"
#include "core/sha256.h"
#include "core/spec.h"

namespace isoline::benchmarks {
namespace {

constexpr const char* kUnknown = "unknown";

std::string or_unknown(const std::string& text) { return text.empty() ? kUnknown : text; }

// Of a component that is none of ours: what was given, as it was given.
Component foreign_component(const std::string& spec) {
  const Spec parsed = parse_spec(spec);
  Component component{.name = parsed.name, .spec = spec, .asked = spec};
  component.options = options_of(parsed);
  component.is_learned = asks_to_learn(component.options);
  return component;
}

Request request_of(const Catalog& catalog, const CurveDescription& told, std::int64_t iterations) {
  const Spec problem = parse_spec(told.problem);
  Request request{.problem = catalog.problems.contains(problem.name)
                                 ? complete_problem(catalog, problem)
                                 : foreign_component(told.problem),
                  .optimizer = foreign_component(told.optimizer),
                  .seed = told.seed,
                  .budget = {.iterations = iterations}};
  const std::string& name = request.optimizer.name;
  require(!catalog.optimizers.contains(name), [&] {
    return fmt::format(
        "{} is an optimizer of ours: name theirs otherwise, as {}-theirs, so that no row mixes both",
        name, name);
  });
  return named(std::move(request));
}

// f_L, s and ‖x*‖, by which the curve's targets are measured.
struct Scales {
  std::optional<Real> minimum, scale, x_scale;
  Real x_floor = 0;
  Aim aim = Aim::loss;
  OracleCounts prices{};
};

// s = min(f₀ − f_L, the problem's scale), as for runs of ours.
std::optional<Real> scale_of(Real start, Real minimum, std::optional<Real> own) {
  const Real descent = start - minimum;
  const Real scale = own && std::isfinite(*own) && *own > 0 ? std::min(*own, descent) : descent;
  return std::isfinite(scale) ? std::optional(std::max(scale, 0.0)) : std::nullopt;
}

Scales told_scales(const CurveDescription& told, Real start) {
  Scales scales{.minimum = told.minimum, .x_scale = told.x_scale};
  if (told.minimum) scales.scale = scale_of(start, *told.minimum, told.scale);
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (has_plain_price(static_cast<Oracle>(kind)))
      scales.prices[kind] = kOracleTable[kind].price({});
  return scales;
}

Scales own_scales(const Catalog& catalog, const Request& request, const CurveDescription& told,
                  Real start) {
  require(!told.minimum && !told.scale && !told.x_scale, [&] {
    return fmt::format(
        "{} is a problem of ours, whose minimum and scales are known: leave out theirs",
        request.problem.name);
  });
  const Problem problem = make_problem(catalog, request.problem, request.seed);
  problems::Batch validation;
  if (problem.is_learned()) problem.draw_validation(validation);
  const problems::Batch& judging = problem.is_learned() ? validation : problem.batch();
  Scales scales{.minimum = problem.minimum(),
                .x_floor = problem.x_floor(judging),
                .aim = problem.aim(),
                .prices = problem.prices()};
  const Real x_scale = problem.x_scale(judging);
  if (std::isfinite(x_scale)) scales.x_scale = x_scale;
  if (scales.minimum) scales.scale = scale_of(start, *scales.minimum, problem.loss_scale(judging));
  return scales;
}

// Where work alone is told it stands for as many forward solves: else the curve would cost nothing.
std::map<std::string, std::vector<std::int64_t>> counts_of(const ForeignCurve& curve) {
  return curve.counts.empty()
             ? std::map<std::string, std::vector<std::int64_t>>{{"forward", curve.work}}
             : curve.counts;
}

// Those that the meter keeps, and the last.
std::vector<std::size_t> kept_points(const ForeignCurve& curve) {
  std::vector<std::size_t> kept;
  std::int64_t next = 0;
  for (std::size_t i = 0; i < curve.points(); ++i)
    if (curve.iteration[i] >= next || i + 1 == curve.points()) {
      kept.push_back(i);
      next = next_kept_after(curve.iteration[i]);
    }
  return kept;
}

template <class Value>
std::vector<Value> at(const std::vector<std::size_t>& places, const std::vector<Value>& column) {
  std::vector<Value> values;
  for (const std::size_t place : places) values.push_back(column[place]);
  return values;
}

Curve kept_curve(const ForeignCurve& all) {
  const std::vector<std::size_t> kept = kept_points(all);
  Curve curve{.iteration = at(kept, all.iteration), .work = at(kept, all.work)};
  for (const auto& [oracle, counts] : counts_of(all)) curve.counts[oracle] = at(kept, counts);
  curve.wall_seconds = at(kept, all.wall_seconds);
  curve.processor_seconds = at(kept, all.processor_seconds);
  curve.loss = at(kept, all.loss);
  curve.x_error = at(kept, all.x_error);
  curve.gradient_norm = at(kept, all.gradient_norm);
  curve.step_norm = at(kept, all.step_norm);
  return curve;
}

// Of all rows, kept or not: the first at or below each target.
Hits hits_of(const ForeignCurve& curve, Real minimum, Real scale) {
  Hits hits;
  const auto counts = counts_of(curve);
  const auto forwards = counts.find("forward");
  std::size_t i = 0;
  for (std::size_t j = 0; j < kRungs; ++j) {
    while (i < curve.points() && !(curve.loss[i] <= minimum + rung(j) * scale)) ++i;
    const bool is_met = i < curve.points();
    const auto count = [&](const std::vector<std::int64_t>& column) {
      return is_met ? column[i] : -1;
    };
    hits.target.push_back(rung(j));
    hits.iteration.push_back(count(curve.iteration));
    hits.work.push_back(count(curve.work));
    hits.forwards.push_back(forwards == counts.end() ? (is_met ? 0 : -1) : count(forwards->second));
    for (const auto& [oracle, column] : counts) hits.counts[oracle].push_back(count(column));
    hits.wall_seconds.push_back(is_met ? curve.wall_seconds[i] : std::nan(""));
  }
  return hits;
}

Summary summary_of(const ForeignCurve& curve) {
  Summary summary{.iterations = curve.iteration.back(),
                  .work = curve.work.back(),
                  .start_loss = curve.loss.front(),
                  .loss = curve.loss.back(),
                  .best_loss = curve.loss.front(),
                  .start_x_error = curve.x_error.front(),
                  .x_error = curve.x_error.back(),
                  .gradient_norm = curve.gradient_norm.back(),
                  .wall_seconds = curve.wall_seconds.back(),
                  .processor_seconds = curve.processor_seconds.back()};
  for (const Real loss : curve.loss)
    if (loss < summary.best_loss || std::isnan(summary.best_loss)) summary.best_loss = loss;
  return summary;
}

// Of a program that we know by hearsay.
Provenance provenance_of(const CurveDescription& told) {
  return Provenance(
      std::make_shared<const Build>(Build{.version = kUnknown,
                                          .commit = kUnknown,
                                          .is_dirty = false,
                                          .compiler = kUnknown,
                                          .flags = kUnknown,
                                          .instruction_set = kUnknown,
                                          .processor = or_unknown(told.processor),
                                          .libraries = {{"program", or_unknown(told.program)}}}),
      {.started = told.date, .concurrent_jobs = 1, .is_exclusive = false});
}

}  // namespace

Record imported_record(const Catalog& catalog, const CurveDescription& told,
                       const ForeignCurve& curve, const ForeignFiles& files) {
  Record record;
  record.request = request_of(catalog, told, curve.iteration.back());
  record.cell = record.request.cell;
  record.build = digest(files.description + files.curve);
  record.build_parts = {{"imported", record.build}};
  const bool is_ours = catalog.problems.contains(record.request.problem.name);
  const Real start = curve.loss.front();
  const Scales scales =
      is_ours ? own_scales(catalog, record.request, told, start) : told_scales(told, start);
  record.status = std::isfinite(curve.loss.back()) ? told.status : Status::diverged;
  record.claimed = told.claimed;
  record.aim = scales.aim;
  record.minimum = scales.minimum;
  record.scale = scales.scale;
  record.x_scale = scales.x_scale;
  record.x_floor = scales.x_floor;
  for (const auto& [tau, value] : kVerified)
    record.verified[tau] = record.found[tau] = std::nullopt;
  record.prices = scales.prices;
  record.summary = summary_of(curve);
  record.curve = kept_curve(curve);
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (const auto found = record.curve.counts.find(std::string(kOracleNames[kind]));
        found != record.curve.counts.end())
      record.counts[kind] = found->second.back();
  if (scales.minimum && scales.scale) record.hits = hits_of(curve, *scales.minimum, *scales.scale);
  record.repeat_wall_seconds = {record.summary.wall_seconds};
  record.provenance = provenance_of(told);
  record.imported = Imported{told.source, told.program, files.curve_name, sha256(files.curve)};
  return record;
}

}  // namespace isoline::benchmarks
