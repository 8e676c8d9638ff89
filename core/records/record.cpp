// Records to JSON and back.
#include "core/records/record.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/ladder.h"
#include "core/records/integrity.h"
#include "core/records/plan.h"
#include "core/records/record_fields.h"

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
  of_curve(curve.work, curve.counts, curve.wall_seconds, curve.processor_seconds, curve.loss,
           curve.x_error, curve.gradient_norm, curve.step_norm, curve.batch_loss,
           curve.batch_x_error, record.series);
  if (record.trajectory) of_curve(record.trajectory->x, record.trajectory->y);
  if (record.fields) require_sound(*record.fields);
  if (record.spectrum)
    require(record.spectrum->iterations.size() == record.spectrum->sigma.size(),
            "its spectra are not as many as their iterations");
  if (!record.hits) return;
  const Hits& hits = *record.hits;
  const std::size_t targets = hits.target.size();
  require(targets <= std::size_t{kRungs}, "its hits have more targets than there are");
  const auto of_hits = [targets](const auto&... columns) {
    (require_length(targets, "hits", columns), ...);
  };
  of_hits(hits.iteration, hits.work, hits.forwards, hits.counts, hits.wall_seconds);
}

}  // namespace

Json to_json(const Record& record) {
  Json json;
  Form<Record>::write(record, JsonPlace(json));
  return json;
}

std::string file_text(const Record& record) { return json_text(to_json(record)) + "\n"; }

Record record_from_text(const std::string& text, const std::string& origin) {
  static thread_local JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    Record record;
    Form<Record>::read(json, record);
    require_equal_columns(record);
    return record;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("no {} record: {}", kRunSchema, error.what()));
  }
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

Json run_schema() {
  Json schema;
  Form<Record>::law(JsonPlace(schema));
  complete_schema(JsonPlace(schema), "isoline.run/1: the record of one run");
  return schema;
}

Json result_of(const Json& record) {
  Json result = without_timings(record);
  result.erase("provenance");
  Json& request = result.at("request");
  request.erase(
      "rates");  // which file chose the options, and how they were typed: the cell has them
  for (const char* component : {"problem", "optimizer"}) request.at(component).erase("asked");
  return result;
}

Json without_timings(Json record) {
  record.erase("repeat_wall_seconds");
  record.erase("output");  // may hold addresses and times
  record.erase("fields");
  record.erase("spectrum");
  record.at("provenance").erase(kRunKey);  // start time, concurrent jobs, exclusive
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
