// Is a record the one that its cell and build name, and the only one in its folder?
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isoline::benchmarks {

using Json = nlohmann::json;

// What is wrong where its cell is not the digest of its request; else empty.
std::string cell_violation(const Json& record);

// What is wrong with the file of fields beside a record that names one; else empty.
std::string fields_violation(const Json& record, const std::filesystem::path& file);

// What a record is known by, and where it stands.
struct RecordIdentity {
  std::string file, cell, build;
};

// A record that differs from another one of its folder, cell and build in more than timings.
struct DoubleRecord {
  std::string file, violation;  // names the other one, and the first places where they differ
};
std::vector<DoubleRecord> double_records(std::vector<RecordIdentity> records);

}  // namespace isoline::benchmarks
