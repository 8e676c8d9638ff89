// What differs between two results is told by its cause, then by optimizer and problem.
#include "reports/compare/causes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "reports/compare/gate.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

using Edit = std::function<void(Record&)>;

// So many optimizers on two problems, three seeds each.
void fill(const ResultFolder& folder, int optimizers, const Edit& edit) {
  for (const char* problem : {"sine", "square"})
    for (int optimizer = 0; optimizer < optimizers; ++optimizer)
      for (std::uint64_t seed : {0, 1, 2}) {
        Record record = record_of({.problem = problem,
                                   .optimizer = "method-" + std::to_string(optimizer),
                                   .seed = seed,
                                   .hits = 20,
                                   .status = Status::budget});
        edit(record);
        record.cell = cell_digest(record.request);
        folder.add(record);
      }
}

GateResult compared(int optimizers, const Edit& before, const Edit& after,
                    const GateOptions& options = {}) {
  const ResultFolder old, now;
  fill(old, optimizers, before);
  fill(now, optimizers, after);
  return compare_results(old.path(), now.path(), options);
}

void as_it_was(Record&) {}

TEST(Causes, AnotherBuildIsOneSentenceHoweverManyCells) {
  const GateResult result = compared(40, as_it_was, [](Record& record) { record.build = "b1"; });
  EXPECT_EQ(result.exit_code, kNotComparable);
  ASSERT_EQ(result.causes.size(), 1U);
  EXPECT_EQ(cause_group_text(result.causes[0]),
            "240 cells of 40 optimizers on sine, square: 240 not comparable");
  const std::string text = gate_terminal(result);
  EXPECT_TRUE(text.starts_with("Comparison: not comparable")) << text;
  EXPECT_LE(lines_in(text), 36U) << text;
  EXPECT_TRUE(has(text, "more; --all lists them")) << text;
  EXPECT_FALSE(has(gate_terminal(result, true), "more; --all lists them"));
}

TEST(Causes, EachIsToldApartWithWhatBecameOfItsCells) {
  const auto changed = [](Record& record) {
    if (record.request.optimizer.name == "method-0") {
      record.request.optimizer.options.set("epsilon", 0.5);
      record.summary.loss *= 2;
    } else if (record.request.optimizer.name == "method-1") {
      record.build_parts["harness"] = "other";
      record.build = "b1";
      record.summary.loss *= record.request.problem.name == "sine" ? 0.5 : 1;
    }
  };
  const auto given = [](Record& record) {
    record.request.optimizer.options.set("epsilon", 0.25);
    record.build_parts["harness"] = "one";
  };
  const GateResult result = compared(3, given,
                                     [&](Record& record) {
                                       given(record);
                                       changed(record);
                                     },
                                     {.tolerance = 1e-6});
  ASSERT_EQ(result.causes.size(), 2U);
  EXPECT_EQ(result.causes[0].cause, "method-0: default of epsilon 0.25 → 0.5");
  EXPECT_EQ(cause_group_text(result.causes[0]), "6 cells of method-0 on sine, square: 6 worse");
  EXPECT_EQ(result.causes[1].cause, "another harness");
  EXPECT_EQ(cause_group_text(result.causes[1]), "3 cells of method-1 on sine: 3 better");
}

TEST(Causes, WhatRoundingExplainsIsOneNumber) {
  const GateResult result = compared(2, as_it_was, [](Record& record) {
    record.summary.loss *= record.request.seed == 0 ? 2 : 1 + 4e-16 * 8;
  });
  EXPECT_EQ(result.exit_code, kWorse) << "bit for bit was asked for";
  EXPECT_EQ(result.differences.size(), 12U);
  ASSERT_EQ(result.causes.size(), 1U);
  EXPECT_EQ(result.causes[0].cause, "the same build and options");
  EXPECT_EQ(result.causes[0].worse.size(), 4U);
  EXPECT_EQ(result.causes[0].rounded(), 8U);
  EXPECT_TRUE(has(cause_group_text(result.causes[0]), "8 different by rounding alone ("));
  EXPECT_TRUE(has(result.verdict, "worse: 4 cells of method-0, method-1, most in "))
      << result.verdict;
}

TEST(Causes, RoundingAloneIsNamedInTheVerdictWithAllItsDigits) {
  const GateResult result = compared(1, as_it_was, [](Record& record) {
    if (record.request.seed == 1) record.summary.loss *= 1 + 4e-15;
  });
  EXPECT_TRUE(has(result.verdict, "worse: by rounding alone, most in ")) << result.verdict;
  EXPECT_NE(result.differences.at(0).before, result.differences[0].after);
}

TEST(Causes, AnotherBudgetIsToldOnceWithWhatDiffers) {
  const auto longer = [](Record& record) { record.request.budget.iterations = 77; };
  const GateResult result = compared(2, as_it_was, longer);
  EXPECT_EQ(result.exit_code, kWorse) << "NEW lacks the cells of BASE";
  EXPECT_EQ(result.lack, "");
  ASSERT_EQ(result.other_terms.size(), 1U);
  EXPECT_EQ(result.other_terms[0].cells, 12U);
  EXPECT_TRUE(has(result.other_terms[0].what, "iterations ")) << result.other_terms[0].what;
  EXPECT_TRUE(has(result.other_terms[0].what, " → 77")) << result.other_terms[0].what;
  EXPECT_TRUE(has(result.verdict, "12 with another budget in NEW, iterations ")) << result.verdict;
  EXPECT_EQ(result.only_before.size(), 12U) << "for machines they are listed on both sides";
  EXPECT_EQ(result.only_after.size(), 12U);
}

TEST(Causes, OneCellIsNoCells) {
  const GateResult result = compared(1, as_it_was, [](Record& record) {
    if (record.request.seed == 1 && record.request.problem.name == "sine") record.summary.loss *= 2;
  });
  EXPECT_EQ(cause_group_text(result.causes.at(0)), "1 cell of method-0 on sine: 1 worse");
  EXPECT_FALSE(has(gate_terminal(result), " 1 cells")) << gate_terminal(result);
}

}  // namespace
}  // namespace isoline::reports
