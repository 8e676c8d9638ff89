// The members of a provenance, as they stand in a record.
#pragma once

#include "core/records/forms.h"
#include "core/records/provenance.h"

namespace isoline {

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

}  // namespace isoline
