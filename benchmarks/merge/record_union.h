// The union of two records of one cell and build, and whether a record is what its names say.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isoline::benchmarks {

using Json = nlohmann::json;

// Makes `record` the union with another record of its cell and build: the timings of both, each
// value as often as the record that has it most often, and the fields and spectrum that either
// keeps. Of the rest the later run's stays; a run that a clock or a kill ended gives way to one
// that ended by itself. Where two results differ it returns the first places, "/summary/loss (1,
// 2)", and changes nothing.
std::string unite_records(Json& record, const Json& other);

// The error if the cell of a record is not the digest of its request; otherwise empty.
std::string cell_violation(const Json& record);

// The error in the file of fields that a record names; otherwise empty.
std::string fields_violation(const Json& record, const std::filesystem::path& file);

// The identity of a record, and its place.
struct RecordIdentity {
  std::string file, cell, build;
};

// A record that differs from another one of its folder, cell and build in more than timings.
struct DoubleRecord {
  std::string file, violation;  // names the other one, and the first places where they differ
};
std::vector<DoubleRecord> double_records(std::vector<RecordIdentity> records);

}  // namespace isoline::benchmarks
