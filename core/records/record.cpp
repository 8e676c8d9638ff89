// Records to JSON and back.
#include "core/records/record.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/json_view.h"

namespace isoline {
namespace {

Json numbers(const std::vector<Real>& values) { return json_numbers(values.data(), values.size()); }

Json rows(const std::vector<std::vector<Real>>& values) {
  Json list = Json::array();
  for (const auto& row : values) list.push_back(numbers(row));
  return list;
}

std::vector<std::vector<Real>> real_rows(const JsonView& list) {
  std::vector<std::vector<Real>> values;
  for (const JsonView& row : list.values()) values.push_back(reals_of(row));
  return values;
}

Json by_window(const std::map<std::int64_t, std::vector<Real>>& columns) {
  Json json = Json::object();
  for (const auto& [window, values] : columns) json[std::to_string(window)] = numbers(values);
  return json;
}

std::map<std::int64_t, std::vector<Real>> windows_from(const JsonView& json) {
  std::map<std::int64_t, std::vector<Real>> columns;
  for (const auto& [window, values] : json.items()) columns[std::stoll(window)] = reals_of(values);
  return columns;
}

Json to_json(const Curve& curve) {
  Json json = {{"iteration", curve.iteration},
               {"work", curve.work},
               {"counts", curve.counts},
               {"wall_seconds", numbers(curve.wall_seconds)},
               {"processor_seconds", numbers(curve.processor_seconds)},
               {"loss", numbers(curve.loss)},
               {"x_error", numbers(curve.x_error)},
               {"gradient_norm", numbers(curve.gradient_norm)},
               {"step_norm", numbers(curve.step_norm)}};
  if (!curve.batch_loss.empty()) json["batch_loss"] = by_window(curve.batch_loss);
  if (!curve.batch_x_error.empty()) json["batch_x_error"] = by_window(curve.batch_x_error);
  return json;
}

Curve curve_from(const JsonView& json) {
  Curve curve;
  json.at("iteration").get_to(curve.iteration);
  json.at("work").get_to(curve.work);
  json.at("counts").get_to(curve.counts);
  curve.wall_seconds = reals_of(json.at("wall_seconds"));
  curve.processor_seconds = reals_of(json.at("processor_seconds"));
  curve.loss = reals_of(json.at("loss"));
  curve.x_error = reals_of(json.at("x_error"));
  curve.gradient_norm = reals_of(json.at("gradient_norm"));
  curve.step_norm = reals_of(json.at("step_norm"));
  if (json.contains("batch_loss")) curve.batch_loss = windows_from(json["batch_loss"]);
  if (json.contains("batch_x_error")) curve.batch_x_error = windows_from(json["batch_x_error"]);
  return curve;
}

Json to_json(const Hits& hits) {
  Json json = {{"target", numbers(hits.target)},
               {"iteration", hits.iteration},
               {"work", hits.work},
               {"forwards", hits.forwards},
               {"wall_seconds", numbers(hits.wall_seconds)}};
  if (!hits.counts.empty()) json["counts"] = hits.counts;
  return json;
}

Hits hits_from(const JsonView& json) {
  Hits hits;
  hits.target = reals_of(json.at("target"));
  json.at("iteration").get_to(hits.iteration);
  json.at("work").get_to(hits.work);
  json.at("forwards").get_to(hits.forwards);
  if (json.contains("counts")) json["counts"].get_to(hits.counts);
  hits.wall_seconds = reals_of(json.at("wall_seconds"));
  return hits;
}

Json to_json(const Summary& summary) {
  return {{"iterations", summary.iterations},
          {"work", summary.work},
          {"rejected_steps", summary.rejected_steps},
          {"start_loss", json_number(summary.start_loss)},
          {"loss", json_number(summary.loss)},
          {"best_loss", json_number(summary.best_loss)},
          {"start_x_error", json_number(summary.start_x_error)},
          {"x_error", json_number(summary.x_error)},
          {"gradient_norm", json_number(summary.gradient_norm)},
          {"wall_seconds", json_number(summary.wall_seconds)},
          {"processor_seconds", json_number(summary.processor_seconds)},
          {"peak_memory_bytes", summary.peak_memory_bytes}};
}

Summary summary_from(const JsonView& json) {
  return {.iterations = json.at("iterations"),
          .work = json.at("work"),
          .rejected_steps = json.at("rejected_steps"),
          .start_loss = real_of(json.at("start_loss")),
          .loss = real_of(json.at("loss")),
          .best_loss = real_of(json.at("best_loss")),
          .start_x_error = real_of(json.at("start_x_error")),
          .x_error = real_of(json.at("x_error")),
          .gradient_norm = real_of(json.at("gradient_norm")),
          .wall_seconds = real_of(json.at("wall_seconds")),
          .processor_seconds = real_of(json.at("processor_seconds")),
          .peak_memory_bytes = json.at("peak_memory_bytes")};
}

Json to_json(const OracleCounts& counts) {
  Json json = Json::object();
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    json[std::string(kOracleNames[kind])] = counts[kind];
  return json;
}

OracleCounts counts_from(const JsonView& json) {
  OracleCounts counts{};
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (json.contains(kOracleNames[kind])) counts[kind] = json.at(kOracleNames[kind]);
  return counts;
}

Json verified_json(const Record& record) {
  Json json = Json::object();
  for (const auto& [tau, is_met] : record.verified) json[tau] = is_met ? Json(*is_met) : Json();
  return json;
}

Record parsed(const JsonView& json) {
  Record record{.cell = json.at("cell"), .build = json.at("build")};
  record.request = request_from_json(json.at("request").json());
  const auto status = status_of(json.at("status").get<std::string>());
  require(status.has_value(),
          [&] { return "unknown status " + json.at("status").get<std::string>(); });
  record.status = *status;
  record.message = json.at("message");
  record.claimed = json.at("claimed");
  if (!json.at("minimum").is_null()) record.minimum = real_of(json.at("minimum"));
  for (const auto& [tau, is_met] : json.at("verified").items())
    record.verified[tau] = is_met.is_null() ? std::nullopt : std::optional(is_met.get<bool>());
  record.counts = counts_from(json.at("counts"));
  record.prices = counts_from(json.at("prices"));
  record.summary = summary_from(json.at("summary"));
  record.curve = curve_from(json.at("curve"));
  if (json.contains("hits")) record.hits = hits_from(json["hits"]);
  if (json.contains("trajectory"))
    record.trajectory = {real_rows(json["trajectory"].at("x")),
                         real_rows(json["trajectory"].at("y"))};
  if (json.contains("series"))
    for (const auto& [name, values] : json["series"].items())
      record.series[name] = reals_of(values);
  if (json.contains("exhibit")) record.exhibit = exhibit_from_json(json["exhibit"].json());
  json.at("privileges").get_to(record.privileges);
  record.is_nondeterministic = json.at("nondeterministic");
  record.repeat_wall_seconds = reals_of(json.at("repeat_wall_seconds"));
  record.provenance = provenance_from(json.at("provenance"));
  return record;
}

}  // namespace

Json to_json(const Record& record) {
  Json json{{"schema", kRunSchema},
            {"cell", record.cell},
            {"build", record.build},
            {"request", to_json(record.request)},
            {"status", name_of(record.status)},
            {"message", record.message},
            {"claimed", record.claimed},
            {"minimum", record.minimum ? json_number(*record.minimum) : Json()},
            {"verified", verified_json(record)},
            {"counts", to_json(record.counts)},
            {"prices", to_json(record.prices)},
            {"summary", to_json(record.summary)},
            {"curve", to_json(record.curve)},
            {"privileges", record.privileges},
            {"nondeterministic", record.is_nondeterministic},
            {"repeat_wall_seconds", numbers(record.repeat_wall_seconds)},
            {"provenance", record.provenance.json()}};
  if (record.hits) json["hits"] = to_json(*record.hits);
  if (record.trajectory)
    json["trajectory"] = {{"x", rows(record.trajectory->x)}, {"y", rows(record.trajectory->y)}};
  for (const auto& [name, values] : record.series) json["series"][name] = numbers(values);
  if (record.exhibit) json["exhibit"] = to_json(*record.exhibit);
  return json;
}

Record record_from_text(const std::string& text, const std::string& origin) {
  static thread_local JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    require(json.at("schema").get<std::string>() == kRunSchema, "its schema is another");
    return parsed(json);
  } catch (const Json::exception& error) {  // in what is kept as JSON: the request, the exhibit
    throw UsageError(fmt::format("no {} record: {}", kRunSchema, error.what()));
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("no {} record: {}", kRunSchema, error.what()));
  }
}

Record record_from_json(const Json& json) { return record_from_text(json.dump(), "it"); }

Record read_record(const std::filesystem::path& path) {
  return record_from_text(read_text(path), path.string());
}

Json without_timings(Json record) {
  record.erase("repeat_wall_seconds");
  record.at("provenance").erase("run");  // start time, concurrent jobs, exclusive
  for (const char* name : {"wall_seconds", "processor_seconds", "peak_memory_bytes"}) {
    record.at("summary").erase(name);
    record.at("curve").erase(name);
  }
  // Counts at hits are the work again by kind; records of older versions are without.
  if (record.contains("hits"))
    for (const char* name : {"wall_seconds", "counts"}) record["hits"].erase(name);
  return record;
}

}  // namespace isoline
