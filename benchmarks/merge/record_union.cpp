// Unites records, and holds their names to what they hold.
#include "benchmarks/merge/record_union.h"

#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/record.h"
#include "core/records/request.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

bool is_nondeterministic(const Json& record) { return record.at("nondeterministic").get<bool>(); }

// Runs that ended by themselves come after those that a clock ended, then the latest; the text
// decides what is left, so that the order of the folders decides nothing.
auto rank_of(const Json& record) {
  Json rest = record;
  for (const char* united : {"repeat_wall_seconds", "fields", "spectrum"}) rest.erase(united);
  const Json run = record.at("provenance").value("run", Json::object());
  return std::tuple(!is_nondeterministic(record),
                    run.is_object() ? run.value("started", std::string()) : std::string(),
                    json_text(rest));
}

Json united_timings(const Json& a, const Json& b) {
  std::vector<Real> left = reals_of(a), right = reals_of(b), both;
  const auto is_less = [](Real x, Real y) { return std::strong_order(x, y) < 0; };  // nan last
  std::ranges::sort(left, is_less);
  std::ranges::sort(right, is_less);
  std::ranges::set_union(left, right, std::back_inserter(both), is_less);
  return json_numbers(both);
}

std::string shown(const Json& value) {
  constexpr std::size_t kMost = 60;
  const std::string text = json_text(value);
  return text.size() > kMost ? std::string(cut(text, kMost)) + "…" : text;
}

// "/summary/loss (1.5, 1.6), /status (…), and 3 more places".
std::string first_differences(const Json& a, const Json& b) {
  constexpr std::size_t kTold = 3;
  const Json patch = Json::diff(a, b);
  std::string text;
  for (std::size_t i = 0; i < std::min(patch.size(), kTold); ++i) {
    const Json::json_pointer place(patch[i].at("path").get<std::string>());
    const auto at = [&](const Json& json) {
      return json.contains(place) ? shown(json.at(place)) : std::string("absent");
    };
    text += fmt::format("{}{} ({}, {})", i == 0 ? "" : ", ", place.to_string(), at(a), at(b));
  }
  if (patch.size() > kTold) text += fmt::format(", and {} more places", patch.size() - kTold);
  return text;
}

auto place_of(const RecordIdentity& record) {
  const std::string_view folder =
      std::string_view(record.file).substr(0, record.file.find_last_of('/') + 1);
  return std::tuple(folder, std::string_view(record.cell), std::string_view(record.build));
}

}  // namespace

std::string unite_records(Json& record, const Json& other) {
  const Json left = result_of(record), right = result_of(other);
  const bool is_same = left == right;
  if (!is_same && !is_nondeterministic(record) && !is_nondeterministic(other))
    return first_differences(left, right);
  const bool is_other = rank_of(record) < rank_of(other);
  Json united = is_other ? other : record;
  for (const char* asked : {"fields", "spectrum"})  // only one of the runs may have kept them
    if (const Json& from = is_other ? record : other;
        is_same && from.contains(asked) && !united.contains(asked))
      united[asked] = from.at(asked);
  united["repeat_wall_seconds"] =
      united_timings(record.at("repeat_wall_seconds"), other.at("repeat_wall_seconds"));
  record = std::move(united);
  return "";
}

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
    Json record = read_json(first.file);
    const std::string difference = unite_records(record, read_json(second.file));
    if (!difference.empty())
      all.push_back({second.file, fmt::format("{} is of the same cell and build and differs at {}",
                                              std::filesystem::path(first.file).filename().string(),
                                              difference)});
  }
  return all;
}

}  // namespace isoline::benchmarks
