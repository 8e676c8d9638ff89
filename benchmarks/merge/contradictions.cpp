// Holds the names of records to what they hold.
#include "benchmarks/merge/contradictions.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>

#include "benchmarks/merge/join.h"
#include "core/digest.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/field_frames.h"
#include "core/records/plan.h"
#include "core/records/request.h"

namespace isoline::benchmarks {
namespace {

auto place_of(const RecordIdentity& record) {
  const std::string_view folder =
      std::string_view(record.file).substr(0, record.file.find_last_of('/') + 1);
  return std::tuple(folder, std::string_view(record.cell), std::string_view(record.build));
}

}  // namespace

std::string cell_violation(const Json& record) {
  const auto claimed = record.at("cell").get<std::string>();
  const std::string cell = request_from_json(record.at("request")).cell;
  if (cell == claimed) return "";
  return fmt::format("its cell is {}, the digest of its request is {}", claimed, cell);
}

std::string fields_violation(const Json& record, const std::filesystem::path& file) {
  if (!record.contains("fields")) return "";
  try {
    const Json& fields = record.at("fields");
    require_sound({.iterations = fields.at("iterations"), .shape = fields.at("shape")});
    const std::string bytes = read_text(field_path(file), kMostRecordBytes);
    if (fields.at("digest") == digest(bytes)) return "";
    return fmt::format("{} beside it is not the file of fields that it names",
                       field_path(file).filename().string());
  } catch (const UsageError& error) {
    return fmt::format("its fields cannot be read: {}", error.what());
  }
}

std::vector<DoubleRecord> double_records(std::vector<RecordIdentity> records) {
  std::ranges::sort(records, {}, [](const RecordIdentity& record) {
    return std::tuple_cat(place_of(record), std::tuple(std::string_view(record.file)));
  });
  std::vector<DoubleRecord> all;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const RecordIdentity &first = records[i - 1], &second = records[i];
    if (place_of(first) != place_of(second)) continue;
    const JoinedRecord both = join_records(read_json(first.file), read_json(second.file));
    if (!both.difference.empty())
      all.push_back({second.file, fmt::format("{} is of the same cell and build and differs at {}",
                                              std::filesystem::path(first.file).filename().string(),
                                              both.difference)});
  }
  return all;
}

}  // namespace isoline::benchmarks
