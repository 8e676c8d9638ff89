// Who answers whom in a comparison: by what was asked, with changed defaults and builds named.
#include "reports/compare/pairing.h"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "reports/compare/baseline.h"
#include "reports/compare/gate.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

constexpr Real kTolerance = 1e-6;  // of the gate of this repository

using Edit = std::function<void(Record&)>;

// Two problems, three optimizers with a default each, two seeds. The digest is made after the edit.
void fill(const ResultFolder& folder, const Edit& edit) {
  for (const char* problem : {"sine", "square"})
    for (const char* optimizer : {"adam", "gd", "levenberg-marquardt"})
      for (std::uint64_t seed : {0, 1}) {
        Record record = record_of({.problem = problem,
                                   .optimizer = optimizer,
                                   .seed = seed,
                                   .hits = 20,
                                   .status = Status::budget});
        record.request.optimizer.options = {{"initial-damping", 1e-4}, {"epsilon", 1e-8}};
        edit(record);
        record.cell = cell_digest(record.request);
        folder.add(record);
      }
}

Edit of_optimizer(const std::string& name, const Edit& edit) {
  return [=](Record& record) {
    if (record.request.optimizer.name == name) edit(record);
  };
}

void as_it_was(Record&) {}

struct Results {
  ResultFolder before, after;
};

GateResult compared(const Edit& edit, GateOptions options = {.tolerance = kTolerance}) {
  const Results results;
  fill(results.before, as_it_was);
  fill(results.after, edit);
  return compare_results(results.before.path(), results.after.path(), options);
}

GateResult held_to_baseline(const Edit& edit, const GateOptions& options) {
  const Results results;
  fill(results.before, as_it_was);
  fill(results.after, edit);
  results.before.add_file("baseline.json", baseline_json(read_study({results.before.path()})));
  return compare_results(results.before.path() / "baseline.json", results.after.path(), options);
}

// The digest of all four cells is another one; what was asked is not.
TEST(Pairing, AChangedDefaultIsComparedAndNamed) {
  const Edit damped = of_optimizer("levenberg-marquardt", [](Record& record) {
    record.request.optimizer.options.set("initial-damping", 1e4);
    record.summary.loss *= 3;
  });
  for (const GateResult& result :
       {compared(damped), held_to_baseline(damped, {.tolerance = kTolerance})}) {
    EXPECT_EQ(result.joined, 12U);
    EXPECT_EQ(result.exit_code, kWorse) << gate_terminal(result);
    EXPECT_EQ(result.settings,
              std::vector<std::string>(
                  {"levenberg-marquardt: default of initial-damping 1e-4 → 1e4 (4 cells)"}));
    EXPECT_TRUE(has(result.verdict, "default of initial-damping 1e-4 → 1e4")) << result.verdict;
    ASSERT_EQ(result.causes.size(), 1U);
    EXPECT_EQ(result.causes[0].cells.size(), 4U);
  }
}

TEST(Pairing, AChangedDefaultWithTheSameFiguresIsAChange) {
  const GateResult result = compared(of_optimizer(
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
  const Results results;
  fill(results.before, of_optimizer("adam", tabled(0.5)));
  fill(results.after, of_optimizer("adam", tabled(0.25)));
  const GateResult result =
      compare_results(results.before.path(), results.after.path(), {.tolerance = kTolerance});
  EXPECT_EQ(result.joined, 12U);
  EXPECT_EQ(result.settings, std::vector<std::string>({"adam: tabled rate 0.5 → 0.25 (4 cells)"}));
}

TEST(Pairing, AnotherBudgetIsAnotherQuestion) {
  const GateResult result =
      compared(of_optimizer("gd", [](Record& record) { record.request.budget.iterations += 1; }));
  EXPECT_EQ(result.joined, 8U);
  EXPECT_EQ(result.only_before.size(), 4U);
  EXPECT_EQ(result.exit_code, kWorse);
}

TEST(Pairing, PartsOfTheBuildThatDifferAreNamedFirst) {
  const auto parts = [](const std::string& platform, const std::string& optimizer) {
    return [=](Record& record) {
      record.build = "b" + platform + optimizer;
      record.build_parts = {{"platform", platform}, {"harness", "h"}, {"optimizer", optimizer}};
    };
  };
  const Results results;
  fill(results.before, parts("1", "1"));
  fill(results.after, [&](Record& record) {
    parts("1", record.request.optimizer.name == "gd" ? "2" : "1")(record);
  });
  results.before.add_file("baseline.json", baseline_json(read_study({results.before.path()})));
  for (const auto& before : {results.before.path(), results.before.path() / "baseline.json"}) {
    const GateResult result =
        compare_results(before, results.after.path(), {.tolerance = kTolerance});
    EXPECT_EQ(result.builds,
              std::vector<std::string>({"another source of the optimizers gd: 4 cells"}));
    const std::string text = gate_terminal(result);
    EXPECT_LT(text.find("Builds that differ"), text.find("Remarks")) << text;
    EXPECT_EQ(result.exit_code, kGood) << text;
  }
}

}  // namespace
}  // namespace isoline::reports
