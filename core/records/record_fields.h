// The members of a record, as they stand in its file: a new one costs its line in record.h, its
// line here, the place that fills it, and the schema renewed (tests/core/run_schema_test.cpp).
#pragma once

#include "core/records/fields.h"
#include "core/records/provenance.h"
#include "core/records/record.h"
#include "core/records/request.h"

namespace isoline {

void fields(Like<Component> auto& component, auto& field) {
  field("name", component.name);
  field("options", component.options);
  field("spec", component.spec);
  field.optional("asked", component.asked, R"({"description": "The spec as typed"})");
  field.optional("revision", component.revision, R"({"description": "Of older records"})");
  if constexpr (std::remove_cvref_t<decltype(field)>::kReads)
    component.is_learned = asks_to_learn(component.options);
}

void fields(Like<Budget> auto& budget, auto& field) {
  field("iterations", budget.iterations);
  field("work", Unlimited{budget.work});
  field("seconds", budget.seconds);
  field("target", budget.target);
}

void fields(Like<Request> auto& request, auto& field) {
  field("problem", request.problem);
  field("optimizer", request.optimizer);
  field("seed", request.seed);
  field("budget", request.budget);
  field("threads", request.threads, R"({"minimum": 1})");
  field("rates", request.rates);
}

// The members of a provenance, as they stand in a record.

inline constexpr const char* kRunKey = "run";

void fields(Like<Build> auto& build, auto& field) {
  field.expected("version", build.version);
  field.expected("commit", build.commit);
  field.expected("dirty", build.is_dirty);
  field.optional("isoline_commit", build.isoline_commit);
  field.expected("compiler", build.compiler);
  field.optional("build_type", build.build_type);
  field.expected("flags", build.flags);
  field.expected("instruction_set", build.instruction_set);
  field.expected("processor", build.processor);
  field.optional("processor_features", build.processor_features);
  field.optional("kernel", build.kernel);
  field.optional("kernel_chosen_by", build.kernel_chosen_by);
  field.optional("cache_bytes", build.cache_bytes);
  field.optional("cores", build.cores);
  field.optional("system", build.system);
  field.expected("libraries", build.libraries);
  field.other(kRunKey);
  field.rest(build.other);
}

void fields(Like<RunProvenance> auto& run, auto& field) {
  field.expected("started", run.started);
  field.expected("concurrent_jobs", run.concurrent_jobs, R"({"minimum": 1})");
  field.expected("exclusive", run.is_exclusive);
  field.forgiven("command", run.command);
  field.rest(run.other, false);
}

// One object of both, the run under a key of its own.
template <>
struct Form<Provenance> {
  static void write(const Provenance& provenance, JsonPlace out) {
    Form<Build>::write(*provenance.build, out);
    if (provenance.run != RunProvenance()) Form<RunProvenance>::write(provenance.run, out[kRunKey]);
  }
  static void read(const JsonView& json, Provenance& provenance) {
    provenance = provenance_from(json);
  }
  static void law(JsonPlace out) {
    Form<Build>::law(out);
    Form<RunProvenance>::law(out["properties"][kRunKey]);
    out["required"].next().set(kRunKey);
  }
};

inline constexpr const char* kDigestLaw = R"({"pattern": "^[0-9a-f]{16}$"})";

inline constexpr const char* kTolerancesLaw = R"({"required": ["1e-1", "1e-3", "1e-6"]})";

void fields(Like<Curve> auto& curve, auto& field) {
  field("iteration", curve.iteration);
  field("work", curve.work);
  field("counts", curve.counts);
  field("wall_seconds", curve.wall_seconds);
  field("processor_seconds", curve.processor_seconds);
  field("loss", curve.loss);
  field("x_error", curve.x_error);
  field("gradient_norm", curve.gradient_norm);
  field("step_norm", curve.step_norm);
  field.optional("batch_loss", curve.batch_loss);
  field.optional("batch_x_error", curve.batch_x_error);
}

void fields(Like<Hits> auto& hits, auto& field) {
  field("target", hits.target);
  field("iteration", hits.iteration);
  field("work", hits.work);
  field("forwards", hits.forwards);
  field.optional("counts", hits.counts,
                 R"({"description": "By oracle, -1 if not reached; older records lack it"})");
  field("wall_seconds", hits.wall_seconds);
}

void fields(Like<Trajectory> auto& path, auto& field) {
  field("x", path.x);
  field("y", path.y);
}

void fields(Like<Summary> auto& summary, auto& field) {
  field("iterations", summary.iterations);
  field("work", summary.work);
  field("rejected_steps", summary.rejected_steps);
  field("start_loss", summary.start_loss);
  field("loss", summary.loss);
  field("best_loss", summary.best_loss);
  field("start_x_error", summary.start_x_error);
  field("x_error", summary.x_error);
  field("gradient_norm", summary.gradient_norm);
  field("wall_seconds", summary.wall_seconds);
  field("processor_seconds", summary.processor_seconds);
  field("peak_memory_bytes", summary.peak_memory_bytes);
}

void fields(Like<Exhibit> auto& exhibit, auto& field) {
  field.optional("grid", exhibit.grid, R"({"minimum": 0, "description": "Of older records"})");
  field.when(!exhibit.is_picture(), "target", exhibit.target);
  field.when(!exhibit.is_picture(), "x", exhibit.x);
  field.when(!exhibit.is_picture(), "truth", exhibit.truth);
}

void fields(Like<FieldFrames> auto& frames, auto& field) {
  field("iterations", frames.iterations);
  field("shape", frames.shape);
  field("digest", frames.digest, kDigestLaw);
}

void fields(Like<Spectrum> auto& spectrum, auto& field) {
  field("iterations", spectrum.iterations);
  field("sigma", spectrum.sigma);
}

void fields(Like<Foreign> auto& foreign, auto& field) {
  field("door", foreign.door, R"({"enum": ["process", "umbridge", "plugin"]})");
  field("command", foreign.command);
  field("digest", foreign.digest, kDigestLaw);
  field.optional("label", foreign.label, R"({"description": "Name in tables"})");
  field.optional("interpreter", foreign.interpreter);
  field.optional("packages", foreign.packages, R"({"description": "Versions by name"})");
  field.optional("note", foreign.note);
  field.optional("source", foreign.source);
}

void fields(Like<ForeignParts> auto& parts, auto& field) {
  field.optional("problem", parts.problem);
  field.optional("optimizer", parts.optimizer);
}

void fields(Like<Imported> auto& imported, auto& field) {
  field("source", imported.source, R"({"minLength": 1})");
  field("program", imported.program);
  field("curve", imported.curve);
  field("sha256", imported.sha256, R"({"pattern": "^[0-9a-f]{64}$"})");
}

void fields(Like<Record> auto& record, auto& field) {
  field.constant("schema", kRunSchema);
  field("cell", record.cell, kDigestLaw);
  field("build", record.build, kDigestLaw);
  field.optional("build_parts", record.build_parts,
                 R"({"description": "By part: platform, harness, problem, optimizer, network"})");
  field("request", record.request);
  field("status", record.status);
  field("message", record.message);
  field.optional("output", record.output,
                 R"({"description": "Its standard output and standard error"})");
  field("claimed", record.claimed);
  field.forgiven("aim", record.aim);
  field("minimum", record.minimum);
  field.optional("best_known", record.is_best_known,
                 R"({"description": "The minimum is the best loss known, and none is declared"})");
  field.forgiven("scale", record.scale, R"({"description": "Older records lack it: f₀ − f_L"})");
  field("verified", record.verified, kTolerancesLaw);
  field.forgiven("x_scale", record.x_scale);
  field.forgiven("x_floor", record.x_floor);
  field.forgiven("found", record.found, kTolerancesLaw);
  field.optional("criterion", record.criterion,
                 R"({"pattern": "^[0-9a-f]{16}$",
                     "description": "Digest of f_L, scale, x_scale, x_floor, aim and prices"})");
  field("counts", record.counts);
  field("prices", record.prices);
  field("summary", record.summary);
  field("curve", record.curve);
  field.optional("hits", record.hits);
  field.optional("trajectory", record.trajectory);
  field.optional("series", record.series);
  field.optional("exhibit", record.exhibit);
  field.optional("fields", record.fields,
                 R"({"description": "x at some iterations, in the .npy file beside the record"})");
  field.optional("spectrum", record.spectrum,
                 R"({"description": "Singular values of J, if --spectrum was set"})");
  field("privileges", record.privileges);
  field.optional("foreign", record.foreign,
                 R"({"description": "Components that other programs computed"})");
  field("nondeterministic", record.is_nondeterministic);
  field("repeat_wall_seconds", record.repeat_wall_seconds);
  field("provenance", record.provenance);
  field.optional(
      "imported", record.imported,
      R"({"description": "The origin of an imported run, whose values are not verified"})");
  if constexpr (std::remove_cvref_t<decltype(field)>::kReads) record.request.cell = record.cell;
}

}  // namespace isoline
