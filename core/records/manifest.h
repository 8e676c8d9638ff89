// What an archive of results holds: its first file, manifest.json, schema isoline.archive/1.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isoline {

using Json = nlohmann::json;

struct ArchivedFile {
  std::string name;  // within the result folder: "runs/03a4d51c22cbf199-821e62446af5cbbe.json"
  std::int64_t bytes = 0;
  std::string sha256;
};

struct Manifest {
  std::vector<std::string> commits;  // of the programs that computed the records, sorted
  std::int64_t records = 0;
  std::vector<ArchivedFile> files;  // by name
};

inline constexpr const char* kArchiveSchema = "isoline.archive/1";
inline constexpr const char* kManifestName = "manifest.json";

std::string file_text(const Manifest& manifest);
// UsageError where it is none, where a name leads out of the folder or stands twice.
Manifest manifest_from_text(const std::string& text, const std::string& origin);

Json manifest_schema();  // what benchmarks/schemas/archive.json holds

}  // namespace isoline
