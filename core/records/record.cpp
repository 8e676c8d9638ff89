// Records to JSON and back.
#include "core/records/record.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/records/record_fields.h"

namespace isoline {

Json to_json(const Record& record) {
  Json json;
  Form<Record>::write(record, JsonPlace(json));
  return json;
}

Record record_from_text(const std::string& text, const std::string& origin) {
  static thread_local JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    Record record;
    Form<Record>::read(json, record);
    return record;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("no {} record: {}", kRunSchema, error.what()));
  }
}

Record record_from_json(const Json& json) { return record_from_text(json.dump(), "it"); }

Record read_record(const std::string& path) { return record_from_text(read_text(path), path); }

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
  record.erase("output");                  // may hold addresses and times
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
