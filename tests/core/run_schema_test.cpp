// The schemas in benchmarks/schemas are what the fields of records, sheets and plans say. After a
// field is added they are renewed by
//   ISOLINE_RENEW_SCHEMAS=1 build/release/tests/core_tests --gtest_filter='Schemas.*'
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/records/plan.h"
#include "core/records/record.h"
#include "core/records/schema.h"
#include "core/records/sheet.h"

namespace isoline {
namespace {

const std::filesystem::path kFolder =
    std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas";

void expect_renewed(const char* file, const Json& schema) {
  if (std::getenv("ISOLINE_RENEW_SCHEMAS") != nullptr) write_json(kFolder / file, schema);
  EXPECT_EQ(read_json(kFolder / file), schema)
      << file << " is not what the fields say: renew it as the first lines of this file tell";
}

TEST(Schemas, AreWhatTheFieldsSay) {
  expect_renewed("run.json", run_schema());
  expect_renewed("component.json", sheet_schema());
  expect_renewed("plan.json", plan_schema());
}

// A record with all that it must have and nothing more.
Record least() {
  Record record{.cell = std::string(16, '0'), .build = std::string(16, '1')};
  record.status = Status::budget;
  for (const auto& [name, tau] : kVerified)
    record.verified[name] = record.found[name] = std::nullopt;
  Build build{.version = "0",
              .commit = "abc",
              .is_dirty = false,
              .compiler = "c",
              .flags = "f",
              .instruction_set = "i",
              .processor = "p",
              .libraries = {{"a", "1"}}};
  record.provenance = Provenance(build);
  record.provenance.run = {
      .started = "now", .concurrent_jobs = 1, .is_exclusive = true, .command = "isoline"};
  return record;
}

TEST(Schemas, OfRecordsRefuseWhatIsMissingUnknownOrOfAnotherType) {
  const Schema schema(run_schema());
  const Json good = to_json(least());
  EXPECT_EQ(schema.violations(good), std::vector<std::string>{});
  for (const char* field : {"cell", "request", "status", "minimum", "summary", "provenance"}) {
    Json broken = good;
    broken.erase(field);
    EXPECT_NE(schema.violations(broken), std::vector<std::string>{}) << field;
  }
  for (const auto& [place, value] : std::map<std::string, Json>{{"/cell", "short"},
                                                                {"/unknown", 1},
                                                                {"/summary/loss", nullptr},
                                                                {"/summary/work", 1.5},
                                                                {"/status", "running"},
                                                                {"/request/threads", 0},
                                                                {"/request/seed", -1},
                                                                {"/provenance/commit", 5},
                                                                {"/verified/1e-3", "yes"},
                                                                {"/counts/forward", -1}}) {
    Json broken = good;
    broken[Json::json_pointer(place)] = value;
    EXPECT_NE(schema.violations(broken), std::vector<std::string>{}) << place;
  }
  Json infinite = good;
  infinite["summary"]["loss"] = "inf";
  EXPECT_EQ(schema.violations(infinite), std::vector<std::string>{});
}

}  // namespace
}  // namespace isoline
