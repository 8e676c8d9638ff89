// Headline figures: counted in the sense of a problem's aim, kept in a baseline, read beside
// others.
#include "reports/compare/trend.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/records/schema.h"
#include "reports/compare/baseline.h"
#include "reports/compare/gate.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// adam reaches 1e-6 on both seeds of two problems, gd 1e-3; newton fails once and makes no sense
// once.
void fill(const ResultFolder& folder) {
  for (const char* problem : {"sine", "square"})
    for (const std::uint64_t seed : {0, 1}) {
      folder.add(record_of({.problem = problem, .optimizer = "adam", .seed = seed}));
      folder.add(record_of({.problem = problem,
                            .optimizer = "gd",
                            .seed = seed,
                            .hits = 20,
                            .status = Status::budget}));
    }
  folder.add(record_of({.optimizer = "newton", .hits = 3, .status = Status::crashed}));
  folder.add(record_of({.optimizer = "newton", .seed = 1, .status = Status::inapplicable}));
}

Headline headline_in(const ResultFolder& folder) {
  const Study study = read_study({folder.path()});
  return headline_of("NEW", subjects_of(study, BestKnown(study)));
}

TEST(Trend, CountsRunsThatReachEachTargetAndWhoSolvesMost) {
  const ResultFolder folder;
  fill(folder);
  const Headline headline = headline_in(folder);
  EXPECT_EQ(headline.runs, 9U);
  EXPECT_EQ(headline.failed, 1U);
  EXPECT_EQ(headline.solved, (std::array<std::size_t, 3>{8, 8, 4}));
  ASSERT_EQ(headline.leaders.size(), 3U);
  EXPECT_EQ(headline.leaders[0].name, "adam");
  EXPECT_EQ(headline.leaders[0].solved, 4U);
  EXPECT_EQ(headline.leaders[0].median_work, 60);  // 30 rungs of 2
  EXPECT_EQ(headline.leaders[1].median_work, kNever);
}

// The loss reaches 1e-6, the error in x, its root, 1e-3.
TEST(Trend, CountsXWhereTheProblemWantsX) {
  const ResultFolder folder;
  Record record = record_of({.hits = 31});
  record.aim = Aim::x;
  record.x_scale = 1;
  folder.add(record);
  EXPECT_EQ(headline_in(folder).solved, (std::array<std::size_t, 3>{1, 1, 0}));
}

TEST(Trend, StandsInTheBaselineAndBesideEarlierOnes) {
  const ResultFolder folder, earlier;
  fill(folder);
  const std::string text = baseline_json(read_study({folder.path()}));
  folder.add_file("baseline.json", text);
  Json first = parse_json(text, "baseline");
  EXPECT_EQ(first["headline"]["solved"], (Json{8, 8, 4}));
  first["headline"]["solved"] = {7, 6, 5};
  earlier.add_file("2026-01-01 0a.json", first.dump());
  first.erase("headline");  // as older ones were: counted from their cells
  earlier.add_file("2026-02-01 0b.json", first.dump());
  earlier.add_file("2026-03-01 0c.json", "{}");  // none of ours is left out
  const GateResult result = compare_results(folder.path() / "baseline.json", folder.path(),
                                            {.tolerance = 1e-6, .earlier = earlier.path()});
  EXPECT_EQ(result.exit_code, kGood) << gate_terminal(result);
  std::vector<std::string> labels;
  for (const Headline& headline : result.trend) labels.push_back(headline.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"2026-01-01 0a", "2026-02-01 0b", "BASE", "NEW"}));
  EXPECT_EQ(result.trend[0].solved, (std::array<std::size_t, 3>{7, 6, 5}));
  EXPECT_EQ(result.trend[1].solved, (std::array<std::size_t, 3>{8, 8, 4}));
  EXPECT_EQ(result.trend[3].runs, 9U);
  const std::string markdown = gate_markdown(result);
  EXPECT_NE(markdown.find("| 2026-01-01 0a | 5/9 | 6/9 | 7/9 | 1 |"), std::string::npos)
      << markdown;
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/comparison.json");
  EXPECT_EQ(schema_violations(parse_json(gate_json(result), "comparison"), schema),
            std::vector<std::string>());
}

TEST(Trend, WithoutEarlierOnesShowsTheTwoSides) {
  const ResultFolder folder, earlier;
  fill(folder);
  const GateResult result =
      compare_results(folder.path(), folder.path(), {.earlier = earlier.path() / "nowhere"});
  EXPECT_EQ(result.exit_code, kGood);
  EXPECT_EQ(result.trend.size(), 2U);
  EXPECT_TRUE(compare_results(folder.path(), folder.path(), {}).trend.empty());
}

}  // namespace
}  // namespace isoline::reports
