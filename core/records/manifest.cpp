// Manifests to JSON and back, and the law on the names of files.
#include "core/records/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/forms.h"

namespace isoline {

void fields(Like<ArchivedFile> auto& file, auto& field) {
  field("name", file.name);
  field("bytes", file.bytes, R"({"minimum": 0})");
  field("sha256", file.sha256, R"({"pattern": "^[0-9a-f]{64}$"})");
}

void fields(Like<Manifest> auto& manifest, auto& field) {
  field.constant("schema", kArchiveSchema);
  field("commits", manifest.commits);
  field("records", manifest.records, R"({"minimum": 0})");
  field("files", manifest.files);
}

namespace {

bool is_plain(unsigned char letter) {
  constexpr unsigned char kDelete = 127;
  return letter >= ' ' && letter != kDelete && letter != '\\';
}

// Of a file below a folder, whatever the folder is.
bool stays_within(const std::string& name) {
  constexpr std::size_t kLongest = 1000;
  if (name.empty() || name.size() > kLongest || !std::ranges::all_of(name, is_plain)) return false;
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    const std::string part = name.substr(at, end - at);
    if (part.empty() || part == "." || part == "..") return false;
    at = end + 1;
  }
  return true;
}

}  // namespace

std::string file_text(const Manifest& manifest) {
  Json json;
  Form<Manifest>::write(manifest, JsonPlace(json));
  return json_text(json, 1) + "\n";
}

Manifest manifest_from_text(const std::string& text, const std::string& origin) {
  JsonReader reader;
  Manifest manifest;
  const JsonView json = reader.parse(text, origin);
  try {
    Form<Manifest>::read(json, manifest);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{} is no {}: {}", origin, kArchiveSchema, error.what()));
  }
  std::set<std::string> names = {kManifestName};
  for (const ArchivedFile& file : manifest.files) {
    require(stays_within(file.name), [&] {
      return fmt::format("{} names '{}', which is no file below a folder", origin, file.name);
    });
    require(names.insert(file.name).second,
            [&] { return fmt::format("{} names {} twice", origin, file.name); });
    require(file.bytes >= 0,
            [&] { return fmt::format("{}: {} has {} bytes", origin, file.name, file.bytes); });
  }
  return manifest;
}

Json manifest_schema() {
  Json schema;
  Form<Manifest>::law(JsonPlace(schema));
  complete_schema(JsonPlace(schema), "isoline.archive/1: what an archive of results holds");
  return schema;
}

}  // namespace isoline
