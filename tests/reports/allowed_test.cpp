// What NEW lacks is worse, unless a list that gives reasons allows it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/schema.h"
#include "reports/compare/gate.h"
#include "reports/compare/pairing.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

void fill(const ResultFolder& folder, const std::vector<std::string>& optimizers) {
  for (const char* problem : {"sine", "square"})
    for (const std::string& optimizer : optimizers)
      for (const std::uint64_t seed : {0, 1})
        folder.add(record_of({.problem = problem, .optimizer = optimizer, .seed = seed}));
}

GateResult compared_without_adam(const AllowedList& allowed) {
  const ResultFolder before, after;
  fill(before, {"adam", "gd", "newton"});
  fill(after, {"gd", "newton"});
  return compare_results(before.path(), after.path(), {.allowed = allowed});
}

TEST(Allowed, AMissingOptimizerIsWorseAndNamedInOneLine) {
  const GateResult result = compared_without_adam({});
  EXPECT_EQ(result.exit_code, kWorse);
  EXPECT_EQ(result.only_before.size(), 4U);
  EXPECT_EQ(result.lack, "all 4 of adam");
  EXPECT_TRUE(has(result.verdict, "NEW lacks 4 cells of BASE (all 4 of adam)")) << result.verdict;
}

TEST(Allowed, WhatTheListAllowsMayBeMissingAndStandsWithItsReason) {
  const GateResult result =
      compared_without_adam({{.problem = "*", .optimizer = "ad*m", .reason = "it was renamed"}});
  EXPECT_EQ(result.exit_code, kGood) << gate_terminal(result);
  EXPECT_TRUE(result.only_before.empty());
  EXPECT_EQ(result.allowed.size(), 4U);
  EXPECT_TRUE(has(gate_terminal(result), "it was renamed")) << gate_terminal(result);
  const GateResult half =
      compared_without_adam({{.problem = "sine", .optimizer = "adam", .reason = "gone"}});
  EXPECT_EQ(half.exit_code, kWorse);
  EXPECT_EQ(half.only_before.size(), 2U);
}

TEST(Allowed, AnEntryOfTheListThatIsNotNeededIsNamed) {
  const GateResult result = compared_without_adam(
      {{.optimizer = "adam", .reason = "gone"}, {.optimizer = "gd", .reason = "gone"}});
  EXPECT_EQ(result.exit_code, kGood);
  EXPECT_TRUE(has(gate_terminal(result), "* × gd, which NEW does not lack"))
      << gate_terminal(result);
}

TEST(Allowed, AListOfAllowedCellsKeepsToItsSchemaAndGivesReasons) {
  const std::filesystem::path tree = ISOLINE_SOURCE_DIR;
  const Json schema = read_json(tree / "benchmarks/schemas/allowed.json");
  EXPECT_EQ(schema_violations(read_json(tree / "benchmarks/baselines/allowed.json"), schema),
            std::vector<std::string>());
  Json list = {{"schema", kAllowedSchema},
               {"cells", {{{"optimizer", "ceres-*"}, {"reason", "built without Ceres"}}}}};
  EXPECT_EQ(schema_violations(list, schema), std::vector<std::string>());
  EXPECT_EQ(allowed_from_json(list).at(0).problem, "*");
  list["cells"][0]["reason"] = "";
  EXPECT_THROW(allowed_from_json(list), UsageError);
  list["cells"][0] = {{"reason", "everything"}};
  EXPECT_THROW(allowed_from_json(list), UsageError);
  EXPECT_THROW(allowed_from_json({{"schema", "isoline.run/1"}}), UsageError);
}

TEST(Allowed, AStarStandsForAnyText) {
  for (const char* pattern : {"*", "sine*", "*[xi=32]", "s*[*]", "sine[xi=32]", "**32*"})
    EXPECT_TRUE(matches(pattern, "sine[xi=32]")) << pattern;
  for (const char* pattern : {"", "sine", "*sine", "sine[xi=3]", "cos*", "*33*"})
    EXPECT_FALSE(matches(pattern, "sine[xi=32]")) << pattern;
}

}  // namespace
}  // namespace isoline::reports
