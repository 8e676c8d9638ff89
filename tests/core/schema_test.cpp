// Violations of a schema are found and said in words.
#include "core/records/schema.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace isoline {
namespace {

TEST(Schema, WhatConformsHasNoViolations) {
  const Json schema{{"type", "object"}, {"required", {"a"}}};
  EXPECT_TRUE(schema_violations({{"a", 1}}, schema).empty());
}

// As a seed is: what reads it as a signed number finds −1.
TEST(Schema, TheLargestIntegerIsNotBelowZero) {
  const Json schema{{"properties", {{"seed", {{"type", "integer"}, {"minimum", 0}}}}}};
  EXPECT_TRUE(schema_violations({{"seed", std::uint64_t{18446744073709551615U}}}, schema).empty());
  EXPECT_FALSE(schema_violations({{"seed", -1}}, schema).empty());
}

TEST(Schema, ViolationsNameTheirPlace) {
  const Json schema{{"type", "object"},
                    {"properties", {{"list", {{"items", {{"type", "integer"}}}}}}}};
  const auto violations = schema_violations({{"list", {1, "two"}}}, schema);
  ASSERT_FALSE(violations.empty());
  bool is_named = false;
  for (const std::string& each : violations) is_named |= each.find("[1]") != std::string::npos;
  EXPECT_TRUE(is_named) << violations[0];
}

}  // namespace
}  // namespace isoline
