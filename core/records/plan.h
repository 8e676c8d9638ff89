// Schema isoline.plan/1: every cell ever planned in a result folder, in order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isoline {

struct Plan;
struct Record;
struct Sheet;

std::string file_text(const Record& record);
std::string file_text(const Plan& plan);
std::string file_text(const Sheet& sheet);

// The largest size of a record or of its snapshots; ours have some ten thousand bytes.
inline constexpr std::size_t kMostRecordBytes = std::size_t{64} << 20;

// Schema isoline.plan/1: every cell ever planned in a result folder, in order.

using Json = nlohmann::json;

struct PlannedCell {
  std::string cell, problem, optimizer;  // digest and specs
  std::uint64_t seed = 0;
};
struct Plan {
  std::vector<std::string> suites;
  std::vector<PlannedCell> cells;
};

inline constexpr const char* kPlanSchema = "isoline.plan/1";

Json to_json(const Plan& plan);
Plan plan_from_text(const std::string& text, const std::string& origin);

Json plan_schema();  // what benchmarks/schemas/plan.json holds

}  // namespace isoline
