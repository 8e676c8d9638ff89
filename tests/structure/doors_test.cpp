// Text that others wrote leaves by one door: what reaches a terminal is printable, and what becomes
// JSON is valid.
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "tests/structure/code.h"

namespace isoline {
namespace {

bool is_product(const Source& source) {
  return !source.is_test() && !source.path.starts_with("benchmarks/micro/") &&
         !source.path.starts_with("clients/");
}

std::set<std::string> users_of(const std::regex& call) {
  std::set<std::string> users;
  for (const Source& source : sources())
    if (is_product(source) && std::regex_search(code_of(source.text), call))
      users.insert(source.path);
  return users;
}

TEST(Doors, WhatAUserReadsIsSaidByOneFunction) {
  const std::regex printing(
      R"(\bfmt::print\b|\bstd::(cout|cerr|clog|puts|printf|fprintf|fputs|perror)\b|\bfwrite\b)");
  EXPECT_EQ(users_of(printing),
            (std::set<std::string>{"benchmarks/run/progress.cpp", "core/text.cpp"}))
      << "say(stdout, …) of core/text.h prints; the live line clears itself besides";
}

TEST(Doors, JsonIsWrittenByOneFunction) {
  EXPECT_EQ(users_of(std::regex(R"((\.|->)dump\()")), std::set<std::string>{"core/json.cpp"})
      << "json_text of core/json.h never throws on text";
}

}  // namespace
}  // namespace isoline
