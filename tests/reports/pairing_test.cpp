// Who answers whom in a comparison, and what explains a difference: by what was asked, with changed
// defaults and builds named.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/reports/gate_fixture.h"

namespace isoline::reports {
namespace {

constexpr Real kTolerance = 1e-6;  // of the gate of this repository

// Three optimizers with a default each. The digest is made after the edit.
Edit with_defaults(const Edit& edit) {
  return [edit](Record& record) {
    record.request.optimizer.options = {{"initial-damping", 1e-4}, {"epsilon", 1e-8}};
    edit(record);
  };
}

void fill(const ResultFolder& folder, const Edit& edit) {
  fill(folder, {"adam", "gd", "levenberg-marquardt"}, with_defaults(edit));
}

Edit of_optimizer(const std::string& name, const Edit& edit) {
  return [=](Record& record) {
    if (record.request.optimizer.name == name) edit(record);
  };
}

// By folders, and by a baseline of the first.
std::vector<GateResult> compared_both_ways(const Edit& before, const Edit& after) {
  const TwoFolders two;
  fill(two.before, before);
  fill(two.after, after);
  two.before.add_file("baseline.json", baseline_json(read_study({two.before.path()})));
  const GateOptions options{.tolerance = kTolerance};
  return {two.compared(options),
          compare_results(two.before.path() / "baseline.json", two.after.path(), options)};
}
GateResult compared_all(const Edit& after) { return compared_both_ways(as_it_was, after)[0]; }

// The digest of all four cells is another one; what was asked is not.
TEST(Pairing, AChangedDefaultIsComparedAndNamed) {
  const Edit damped = of_optimizer("levenberg-marquardt", [](Record& record) {
    record.request.optimizer.options.set("initial-damping", 1e4);
    end_at(record, 3 * record.summary.loss);
  });
  for (const GateResult& result : compared_both_ways(as_it_was, damped)) {
    EXPECT_EQ(result.joined, 12U);
    EXPECT_EQ(result.exit_code, kWorse) << gate_terminal(result);
    ASSERT_EQ(result.settings.size(), 1U);
    EXPECT_TRUE(result.settings[0].starts_with(
        "levenberg-marquardt: default of initial-damping 0.0001 → 10000 (4 cells"))
        << result.settings[0];
    EXPECT_TRUE(has(result.verdict, "default of initial-damping 0.0001 → 10000")) << result.verdict;
    ASSERT_EQ(result.causes.size(), 1U);
    EXPECT_EQ(result.causes[0].cells.size(), 4U);
  }
}

TEST(Pairing, AChangedDefaultWithTheSameFiguresIsAChange) {
  const GateResult result = compared_all(of_optimizer(
      "adam", [](Record& record) { record.request.optimizer.options.set("epsilon", 1e-2); }));
  EXPECT_EQ(result.exit_code, kGood);
  EXPECT_TRUE(has(result.verdict, "adam: default of epsilon 1e-8 → 0.01")) << result.verdict;
}

TEST(Pairing, ATabledRateThatChangedIsNoDefault) {
  const auto tabled = [](Real rate) {
    return [rate](Record& record) {
      record.request.optimizer.options.set("rate", rate);
      record.request.optimizer.asked = "adam";
      record.request.optimizer.spec = "adam[rate=" + option_text(OptionValue(rate)) + "]";
    };
  };
  const GateResult result =
      compared_both_ways(of_optimizer("adam", tabled(0.5)), of_optimizer("adam", tabled(0.25)))[0];
  EXPECT_EQ(result.joined, 12U);
  ASSERT_EQ(result.settings.size(), 1U);
  EXPECT_TRUE(result.settings[0].starts_with("adam: tabled rate 0.5 → 0.25 (4 cells"));
}

TEST(Pairing, PartsOfTheBuildThatDifferAreNamedFirst) {
  const auto parts = [](const std::string& platform, const std::string& optimizer) {
    return [=](Record& record) {
      record.build = "b" + platform + optimizer;
      record.build_parts = {{"platform", platform}, {"harness", "h"}, {"optimizer", optimizer}};
    };
  };
  const Edit after = [&](Record& record) {
    parts("1", record.request.optimizer.name == "gd" ? "2" : "1")(record);
  };
  for (const GateResult& result : compared_both_ways(parts("1", "1"), after)) {
    EXPECT_EQ(result.builds, std::vector<std::string>({"another source of the optimizer (4 cells "
                                                       "of gd on sine, square)"}));
    const std::string text = gate_terminal(result);
    EXPECT_LT(text.find("Builds that differ"), text.find("Remarks")) << text;
    EXPECT_EQ(result.exit_code, kGood) << text;
  }
}

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

// So many optimizers, three seeds each.
GateResult compared(std::size_t optimizers, const Edit& before, const Edit& after,
                    const GateOptions& options = {}) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < optimizers; ++i) names.push_back("method-" + std::to_string(i));
  const TwoFolders two;
  fill(two.before, names, before, 3);
  fill(two.after, names, after, 3);
  return two.compared(options);
}

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
      end_at(record, 2 * record.summary.loss);
    } else if (record.request.optimizer.name == "method-1") {
      record.build_parts["harness"] = "other";
      record.build = "b1";
      end_at(record, record.summary.loss * (record.request.problem.name == "sine" ? 0.7 : 1));
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
  EXPECT_TRUE(result.causes[1].cause.starts_with("another harness"));
  EXPECT_EQ(cause_group_text(result.causes[1]), "3 cells of method-1 on sine: 3 better");
}

TEST(Causes, AnotherBudgetIsToldOnce) {
  const auto longer = [](Record& record) { record.request.budget.iterations = 77; };
  const GateResult result = compared(2, as_it_was, longer);
  EXPECT_EQ(result.exit_code, kWorse) << "NEW lacks the cells of BASE";
  EXPECT_TRUE(has(result.verdict, "(12 with another budget or other threads in NEW)"))
      << result.verdict;
  EXPECT_EQ(result.only_before.size(), 12U) << "for machines they are listed on both sides";
  EXPECT_EQ(result.only_after.size(), 12U);
}

TEST(Causes, OneCellIsNoCells) {
  const GateResult result = compared(1, as_it_was, [](Record& record) {
    if (record.request.seed == 1 && record.request.problem.name == "sine") loss_times(2)(record);
  });
  EXPECT_EQ(cause_group_text(result.causes.at(0)), "1 cell of method-0 on sine: 1 worse");
  EXPECT_FALSE(has(gate_terminal(result), " 1 cells")) << gate_terminal(result);
}

}  // namespace
}  // namespace isoline::reports
