// Records, requests and plans: the members of their files, and values that follow from them.
#include "core/records/record.h"

#include <fmt/format.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/options.h"
#include "core/records/fields.h"
#include "core/records/naming.h"
#include "core/records/npy.h"
#include "core/status.h"

namespace isoline {
namespace {

template <class Column>
void require_length(std::size_t length, const char* whose, const Column& column) {
  require(column.size() == length,
          [&] { return fmt::format("the columns of its {} differ in length", whose); });
}

template <class Key, class Column>
void require_length(std::size_t length, const char* whose, const std::map<Key, Column>& columns) {
  for (const auto& [key, column] : columns) require_length(length, whose, column);
}

// A reader of one row of a column reads the whole column.
void require_equal_columns(const Record& record) {
  const Curve& curve = record.curve;
  const auto of_curve = [points = curve.iteration.size()](const auto&... columns) {
    (require_length(points, "curve", columns), ...);
  };
  of_curve(curve.work, curve.counts, curve.rounds, curve.wall_seconds, curve.processor_seconds,
           curve.loss, curve.x_error, curve.gradient_norm, curve.step_norm, curve.batch_loss,
           curve.batch_x_error, record.series);
  if (!curve.kkt_residual.empty()) of_curve(curve.kkt_residual);
  if (!curve.discrepancy.empty()) of_curve(curve.discrepancy);
  for_each_part(record, [&](const auto& part) {
    if (!part) return;
    if constexpr (requires { require_sound(*part, curve.iteration.size()); })
      require_sound(*part, curve.iteration.size());
    else if constexpr (requires { require_sound(*part); })
      require_sound(*part);
  });
  for (const std::optional<Hits>* each : {&record.hits, &record.x_hits}) {
    if (!*each) continue;
    const Hits& hits = **each;
    const std::size_t targets = hits.target.size();
    require(targets <= std::size_t{kRungs}, "it reached more targets than exist");
    const auto of_hits = [targets](const auto&... columns) {
      (require_length(targets, "hits", columns), ...);
    };
    of_hits(hits.iteration, hits.work, hits.forwards, hits.counts, hits.rounds, hits.wall_seconds);
  }
}

}  // namespace

constexpr const char *kCountsLaw = R"({"items": {"type": "integer", "minimum": 0}})",
                     *kTimesLaw = R"({"items": {"allOf": [{"$ref": "#/definitions/number"},
                                                          {"minimum": 0}]}})";
// For hits: −1 if not reached.
constexpr const char* kHitsLaw = R"({"items": {"type": "integer", "minimum": -1}})";

void fields(Like<Component> auto& component, auto& field) {
  field("name", component.name);
  field("options", component.options);
  field("spec", component.spec);
  field.optional("asked", component.asked, R"({"description": "The spec as typed"})");
  if constexpr (std::remove_cvref_t<decltype(field)>::kReads)
    component.is_learned = asks_to_learn(component.options);
}

void fields(Like<Budget> auto& budget, auto& field) {
  field("iterations", budget.iterations, kCountLaw);
  field("work", Unlimited{budget.work}, kCountLaw);
  field("seconds", budget.seconds, kCountLaw);
  field("target", budget.target, kCountLaw);
  field.optional(
      "stall", budget.stall,
      R"({"minimum": 0, "description": "Iterations without progress, if not 100; 0: any"})");
  field.optional("discrepancy", budget.discrepancy,
                 R"({"description": "τ of the discrepancy principle, if it stops the run"})");
}

void fields(Like<Request> auto& request, auto& field) {
  field("problem", request.problem);
  field("optimizer", request.optimizer);
  field("seed", request.seed);
  field("budget", request.budget);
  field("threads", request.threads, R"({"minimum": 1})");
  field("rates", request.rates);
}

constexpr const char* kRunKey = "run";

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
  field.allow_others();
}

void fields(Like<RunProvenance> auto& run, auto& field) {
  field.expected("started", run.started);
  field.expected("concurrent_jobs", run.concurrent_jobs, R"({"minimum": 1})");
  field.expected("exclusive", run.is_exclusive);
  field.forgiven("command", run.command);
}

// One copy of each build's part for all records that a thread reads.
void read_provenance(const JsonView& json, Provenance& provenance) {
  constexpr std::size_t kMostBuilds = 1000;
  static thread_local std::unordered_map<std::string, std::shared_ptr<const Build>> builds;
  std::string text;
  for (const auto& [key, value] : json.items())
    if (key == kRunKey)
      Form<RunProvenance>::read(value, provenance.run);
    else
      text += fmt::format("{}:{},", key, value.text());
  if (builds.size() > kMostBuilds) builds.clear();
  std::shared_ptr<const Build>& build = builds[text];
  if (build == nullptr) {
    const auto read = std::make_shared<Build>();
    Form<Build>::read(json, *read);
    build = read;
  }
  provenance.build = build;
}

// One object of both, the run under a key of its own.
template <>
struct Form<Provenance> {
  static void write(const Provenance& provenance, JsonText& out) {
    FieldWriter writer(out);
    fields(*provenance.build, writer);
    writer.optional(kRunKey, provenance.run);
  }
  static void read(const JsonView& json, Provenance& provenance) {
    read_provenance(json, provenance);
  }
  static void law(Json& out) {
    Form<Build>::law(out);
    Form<RunProvenance>::law(out["properties"][kRunKey]);
    out["required"].push_back(kRunKey);
  }
};

constexpr const char* kTolerancesLaw = R"({"required": ["1e-1", "1e-3", "1e-6"]})";

void fields(Like<Curve> auto& curve, auto& field) {
  field("iteration", curve.iteration, kCountsLaw);
  field("work", curve.work, kCountsLaw);
  field("counts", curve.counts);
  field.optional("rounds", curve.rounds,
                 R"({"description": "By number of workers, if the work is forward solves only"})");
  field("wall_seconds", curve.wall_seconds, kTimesLaw);
  field("processor_seconds", curve.processor_seconds, kTimesLaw);
  field("loss", curve.loss);
  field("x_error", curve.x_error);
  field("gradient_norm", curve.gradient_norm);
  field("step_norm", curve.step_norm);
  field.optional("kkt_residual", curve.kkt_residual,
                 R"({"description": "‖θ − Π(θ − ∇L)‖ with Π onto the bounds, if there are any"})");
  field.optional("discrepancy", curve.discrepancy,
                 R"({"description": "‖y − y*‖ of the data, if their noise level is known"})");
  field.optional("batch_loss", curve.batch_loss);
  field.optional("batch_x_error", curve.batch_x_error);
}

void fields(Like<Hits> auto& hits, auto& field) {
  field("target", hits.target);
  field("iteration", hits.iteration, kHitsLaw);
  field("work", hits.work, kHitsLaw);
  field("forwards", hits.forwards, kHitsLaw);
  field.optional("counts", hits.counts, R"({"description": "By oracle, -1 if not reached"})");
  field.optional("rounds", hits.rounds,
                 R"({"description": "By number of workers, -1 if not reached"})");
  field("wall_seconds", hits.wall_seconds, kTimesLaw);
}

void fields(Like<Summary> auto& summary, auto& field) {
  field("iterations", summary.iterations, kCountLaw);
  field("work", summary.work, kCountLaw);
  field("rejected_steps", summary.rejected_steps, kCountLaw);
  field("start_loss", summary.start_loss);
  field("loss", summary.loss);
  field("best_loss", summary.best_loss);
  field("start_x_error", summary.start_x_error);
  field("x_error", summary.x_error);
  field("gradient_norm", summary.gradient_norm);
  field("wall_seconds", summary.wall_seconds, kCountLaw);
  field("processor_seconds", summary.processor_seconds, kCountLaw);
  field("peak_memory_bytes", summary.peak_memory_bytes, kCountLaw);
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
  field.optional(
      "build_parts", record.build_parts,
      R"({"description": "By part: platform, harness, problem, optimizer, network, best"})");
  field("request", record.request);
  field("status", record.status);
  field("message", record.message);
  field.optional("output", record.output,
                 R"({"description": "Its standard output and standard error"})");
  field("claimed", record.claimed);
  field.forgiven("aim", record.aim);
  field("minimum", record.minimum);
  field.optional(
      "best_known", record.is_best_known,
      R"({"description": "The minimum is the lowest known loss; the problem does not declare it"})");
  field.forgiven(
      "scale", record.scale,
      R"({"description": "The scale of the loss; older records do not have it, and use f₀ − f_L"})");
  field("verified", record.verified, kTolerancesLaw);
  field.forgiven("x_scale", record.x_scale);
  field.forgiven("x_floor", record.x_floor);
  field.optional("noise_level", record.noise_level,
                 R"({"description": "δ, the expected norm of the noise in the data"})");
  field.forgiven("found", record.found, kTolerancesLaw);
  field.optional("criterion", record.criterion,
                 R"({"pattern": "^[0-9a-f]{16}$",
                     "description": "Digest of f_L, scale, x_scale, x_floor, aim and nominal costs"})");
  field("counts", record.counts);
  field("prices", record.prices);
  field("summary", record.summary);
  field("curve", record.curve);
  field.optional("hits", record.hits);
  field.optional("x_hits", record.x_hits,
                 R"({"description": "The same of the error in x, at every evaluated x"})");
  field.optional("series", record.series);
  for_each_part(record, [&](auto& part) {
    constexpr Part kPart = std::remove_cvref_t<decltype(*part)>::kPart;
    field.optional(kPart.member, part, kPart.law);
  });
  field("privileges", record.privileges);
  field.optional("foreign", record.foreign,
                 R"({"description": "Components that other programs computed"})");
  field("nondeterministic", record.is_nondeterministic);
  field("repeat_wall_seconds", record.repeat_wall_seconds, kTimesLaw);
  field("provenance", record.provenance);
  field.optional(
      "imported", record.imported,
      R"({"description": "The origin of an imported run, whose values are not verified"})");
  if constexpr (std::remove_cvref_t<decltype(field)>::kReads) {
    record.request.cell = record.cell;
    record.request.problem.foreign = record.foreign.problem;
    record.request.optimizer.foreign = record.foreign.optimizer;
    require_equal_columns(record);
  }
}

void fields(Like<PlannedCell> auto& cell, auto& field) {
  field("cell", cell.cell, kDigestLaw);
  field("problem", cell.problem);
  field("optimizer", cell.optimizer);
  field("seed", cell.seed);
}

void fields(Like<Plan> auto& plan, auto& field) {
  field.constant("schema", "isoline.plan/1");
  field("suites", plan.suites);
  field("cells", plan.cells);
}

// Records.

Json to_json(const Record& record) { return json_of(record); }
std::string file_text(const Record& record) { return file_text_of(record); }
Json run_schema() { return schema_of<Record>("isoline.run/1: the record of one run"); }

Record record_from_text(const std::string& text, const std::string& origin) {
  return from_text<Record>(text, origin, "not a record (isoline.run/1)");
}

Record read_unchecked_record(const std::string& path) {
  return record_from_text(read_text(path, kMostRecordBytes), path);
}

Record read_record(const std::string& path) {
  Record record = read_unchecked_record(path);
  const std::vector<std::string> broken = broken_invariants(record);
  require(broken.empty(), [&] { return "it contradicts itself: " + broken.front(); });
  return record;
}

namespace {

const std::set<std::string>& paths_of_timings() {
  static const std::set<std::string> paths = [] {
    std::set<std::string> all = {"repeat_wall_seconds", "output"};  // may hold addresses and times
    for_each_part(Parts(), [&](const auto& part) {
      constexpr Part kPart = std::remove_cvref_t<decltype(*part)>::kPart;
      const std::string ignored = kPart.ignored, member = kPart.member;
      if (!ignored.empty()) all.insert(ignored == "*" ? member : member + "/" + ignored);
    });
    // Start time, concurrent jobs, exclusive.
    all.insert(std::string("provenance/") + kRunKey);
    for (const std::string name : {"wall_seconds", "processor_seconds", "peak_memory_bytes"})
      all.insert({"summary/" + name, "curve/" + name});
    for (const std::string hits : {"hits/", "x_hits/"})  // whose counts are the work again by kind
      all.insert({hits + "wall_seconds", hits + "counts"});
    return all;
  }();
  return paths;
}

Json without(Json record, const std::set<std::string>& paths) {
  for (const std::string& path : paths) {
    Json* at = &record;
    std::size_t begin = 0;
    for (std::size_t end; at && (end = path.find('/', begin)) != path.npos; begin = end + 1) {
      const auto inner = at->find(path.substr(begin, end - begin));
      at = inner == at->end() ? nullptr : &*inner;
    }
    if (at) at->erase(path.substr(begin));
  }
  return record;
}

}  // namespace

const std::set<std::string>& paths_beside_results() {
  static const std::set<std::string> paths = [] {
    std::set<std::string> all = paths_of_timings();
    // Which file chose the options, and how they were typed.
    all.insert({"provenance", "request/rates", "request/problem/asked", "request/optimizer/asked"});
    return all;
  }();
  return paths;
}

Json result_of(const Json& record) { return without(record, paths_beside_results()); }
Json without_timings(Json record) { return without(std::move(record), paths_of_timings()); }

std::map<std::string, std::string> member_texts(const Record& record,
                                                const std::set<std::string>& left_out) {
  JsonText out(left_out);
  Form<Record>::write(record, out);
  return out.take_members();
}

// Requests and plans.

bool asks_to_learn(const OptionValues& options) { return options.text(kModeOption) == kLearnMode; }

bool is_instance_of(OptionValues direct, OptionValues learned) {
  if (asks_to_learn(direct) || !asks_to_learn(learned)) return false;
  for (const char* of_learning : kLearningOptions) {
    direct.erase(of_learning);
    learned.erase(of_learning);
  }
  return direct == learned;
}

// A JSON object with its keys in order.
CellNames::CellNames(const Request& request) {
  const Json shared{{"budget", json_of(request.budget)},
                    {"optimizer", request.optimizer.name},
                    {"optimizer_options", to_json(without_empty(request.optimizer.options))},
                    {"problem", request.problem.name},
                    {"problem_options", to_json(without_empty(request.problem.options))}};
  before_ = json_text(shared);
  before_.pop_back();  // its brace
  before_ += ",\"seed\":";
  after_ = ",\"threads\":" + std::to_string(request.threads) + "}";
}

std::string CellNames::of(std::uint64_t seed) const {
  return digest(before_ + std::to_string(seed) + after_);
}

RatesKind kind_of_rates(const std::string& file) {
  if (file.empty()) return RatesKind::none;
  return file.ends_with("-tuned.json") ? RatesKind::tuned : RatesKind::published;
}

std::string cell_digest(const Request& request) { return CellNames(request).of(request.seed); }

Request named(Request request) {
  request.cell = cell_digest(request);
  return request;
}

Json to_json(const Request& request) { return json_of(request); }

Request request_from_json(const Json& json) {
  return named(from_text<Request>(json_text(json), "a request", "not a request"));
}

Budget budget_from(const JsonView& json) {
  Budget budget;
  Form<Budget>::read(json, budget);
  return budget;
}

namespace {

constexpr std::string_view kPart = "part of ";

}  // namespace

std::string part_of_suite(const std::string& label) { return std::string(kPart) + label; }

void add_suite(std::vector<std::string>& suites, const std::string& suite) {
  const auto is_part = [](const std::string& one) { return one.starts_with(kPart); };
  const auto whole = [&](const std::string& one) {
    return is_part(one) ? one.substr(kPart.size()) : one;
  };
  const auto name_in = [&](const std::string& one) {
    return whole(one).substr(0, whole(one).find('@'));
  };
  const auto with_version = [&](const std::string& one) {
    return one.find('@') == one.npos ? whole(one) + "@1" : whole(one);
  };
  for (std::string& known : suites) {
    if (name_in(known) != name_in(suite)) continue;
    require(with_version(known) == with_version(suite), [&] {
      return fmt::format(
          "results of {} and {} cannot be combined, since the settings of a suite differ between "
          "its versions; keep each version in its own folder, and report it alone",
          with_version(known), with_version(suite));
    });
    const bool are_parts = is_part(suite) && is_part(known);
    const std::string label = std::max(whole(suite), whole(known));  // the one with its version
    known = are_parts ? part_of_suite(label) : label;
    return;
  }
  suites.push_back(suite);
}

Json to_json(const Plan& plan) { return json_of(plan); }
std::string file_text(const Plan& plan) { return file_text_of(plan); }
Plan plan_from_text(const std::string& text, const std::string& origin) {
  return from_text<Plan>(text, origin, "not a plan (isoline.plan/1)");
}
Json plan_schema() {
  return schema_of<Plan>("isoline.plan/1: every cell ever planned in a result folder");
}

}  // namespace isoline
