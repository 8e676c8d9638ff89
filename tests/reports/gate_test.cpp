// The gate: a worse result is found, the same result passes, and what cannot be compared is named.
#include "reports/compare/gate.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "tests/reports/gate_fixture.h"

namespace isoline::reports {
namespace {

const std::filesystem::path kTree = ISOLINE_SOURCE_DIR;

TEST(Gate, TwoRunsOfOneBuildAreEqual) {
  const GateResult result = compared([](Record& record) {
    record.summary.wall_seconds = 99;  // times and provenance of a run may differ
    record.curve.wall_seconds.back() = 99;
    record.provenance.run.started = "2026-07-01T00:00:00Z";
  });
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.joined, 12U);
  EXPECT_EQ(result.equal, 12U);
  EXPECT_TRUE(result.differences.empty());
  EXPECT_EQ(result.verdict, "equal");
  EXPECT_TRUE(has(gate_terminal(result), "too few repetitions"));
}

TEST(Gate, CatchesFivePercentOfQualityInOneCell) {
  const GateResult loss = compared(loss_times(1.05));
  EXPECT_EQ(loss.exit_code, 2);
  ASSERT_EQ(loss.differences.size(), 1U);
  EXPECT_EQ(loss.differences[0].what, "loss");
  EXPECT_NEAR(loss.differences[0].relative, 0.05, 1e-12);
  EXPECT_EQ(loss.equal, 11U);
  const GateResult error =
      compared([](Record& record) { end_in_x_at(record, 1.05 * record.summary.x_error); },
               {.tolerance = 0.01});
  EXPECT_EQ(error.exit_code, 2);
  EXPECT_EQ(error.differences.at(0).what, "error in x");
  const GateResult work = compared(take_five_percent_more_work);
  EXPECT_EQ(work.exit_code, 2);
  EXPECT_TRUE(has(work.differences.at(0).what, "work to ")) << work.differences.at(0).what;
  EXPECT_TRUE(has(work.differences.at(0).note, "more like it"));
}

TEST(Gate, AToleranceLetsSmallDifferencesPass) {
  EXPECT_EQ(compared(loss_times(1 + 1e-9)).exit_code, 2);
  EXPECT_EQ(compared(loss_times(1 + 1e-9), {.tolerance = 1e-6}).exit_code, 0);
  // Below 1e-16 of the start there is rounding alone; not-a-number is no better than infinite.
  const auto rounding = [](Record& record) { end_at(record, record.summary.loss + 5e-17); };
  EXPECT_EQ(compared(rounding, {.tolerance = 0}).exit_code, 0);
  EXPECT_EQ(compared(loss_times(std::nan("")), {.tolerance = 1}).exit_code, 2);
}

TEST(Gate, ABetterStatusIsBetter) {
  EXPECT_EQ(compared(ends_as(Status::converged)).exit_code, 3);
  EXPECT_EQ(compared(ends_as(Status::stalled)).exit_code, 0);  // changed, and said so
  EXPECT_EQ(compared(loss_times(0.5)).exit_code, 3);
}

TEST(Gate, ListsWhatIsWorstFirst) {
  const TwoFolders two;
  for (const auto& [seed, factor] : {std::pair{0, 1.1}, {1, 3.0}, {2, 0.99}, {3, 1.0}, {4, 1.2}}) {
    Record record =
        record_of({.seed = static_cast<std::uint64_t>(seed), .status = Status::converged});
    two.before.add(record);
    end_at(record, record.summary.loss * factor);
    if (seed == 3) record.status = Status::failed;
    two.after.add(record);
  }
  std::vector<std::string> order;
  for (const Difference& difference : two.compared().differences)
    order.push_back(difference.title.substr(difference.title.size() - 1) + " " + difference.what);
  EXPECT_EQ(order, (std::vector<std::string>{"3 status", "1 loss", "4 loss", "0 loss", "2 loss"}));
}

TEST(Gate, WhatNoFigureShowsIsCalledByItsNameAndInThePathIsWorse) {
  const GateResult path = compared([](Record& record) { record.curve.step_norm[2] *= 2; });
  EXPECT_EQ(path.exit_code, 2);
  EXPECT_EQ(path.equal, 11U);
  ASSERT_EQ(path.differences.size(), 1U);
  EXPECT_EQ(path.differences[0].change, Change::worse);
  EXPECT_TRUE(has(path.differences[0].note, "the path differs"));
  const GateResult beside = compared([](Record& record) { record.message = "as it likes"; });
  EXPECT_EQ(beside.exit_code, 0);
  ASSERT_EQ(beside.differences.size(), 1U);
  EXPECT_EQ(beside.differences[0].what, "message");
  EXPECT_FALSE(has(gate_terminal(beside), "the path differs")) << gate_terminal(beside);
}

// Of three cells that end at another x, one has another loss, and one is near.
TEST(Gate, NamesCellsOfEqualLossAtAnotherX) {
  const auto ends_at = [](const std::vector<Real>& x, Real factor = 1) {
    return [x, factor](Record& record) {
      loss_times(factor)(record);
      record.summary.best_loss = record.summary.loss;
      record.answer = AnswerPoints{.unknowns = 2, .points = {kReturned}, .x = {x}};
    };
  };
  const TwoFolders two;
  fill(two.before, {{3, ends_at({1, 2})}, {5, ends_at({1, 2})}, {7, ends_at({1, 2})}});
  fill(two.after, {{3, ends_at({-1, 2}, 1.5)}, {5, ends_at({-1, 2})}, {7, ends_at({1, 2.001})}});
  const GateResult result = two.compared();
  EXPECT_EQ(result.equal, 9U) << "each of the three is another answer";
  ASSERT_EQ(result.elsewhere.size(), 1U);
  EXPECT_TRUE(has(result.elsewhere[0].title, "seed 5")) << result.elsewhere[0].title;
  EXPECT_TRUE(result.elsewhere[0].reason.ends_with(" 2")) << result.elsewhere[0].reason;
  for (const std::string& text : {gate_terminal(result), gate_markdown(result), gate_json(result)})
    EXPECT_TRUE(has(text, result.elsewhere[0].reason)) << text;
  EXPECT_TRUE(compared(as_it_was).elsewhere.empty());
}

// Without f_L there are no targets: a path that takes longer to the same end is found all the same.
TEST(Gate, ASlowerPathIsWorseWhereNoMinimumIsKnown) {
  const auto unknown = [](Record& record) {
    record.minimum.reset();
    record.hits.reset();
  };
  const auto slower = [&](Record& record) {
    unknown(record);
    for (std::size_t i = 1; i + 2 < record.curve.loss.size(); ++i) record.curve.loss[i] *= 1.4;
  };
  const TwoFolders two;
  fill(two.before, {{5, unknown}});
  fill(two.after, {{5, slower}});
  const GateResult result = two.compared({.tolerance = 1e-6});
  EXPECT_EQ(result.exit_code, kWorse);
  EXPECT_TRUE(result.differences.at(0).what.ends_with(" path"));
}

TEST(Gate, AllFormatsTellTheSame) {
  const GateResult result = compared(loss_times(1.05));
  for (const std::string& text : {gate_terminal(result), gate_markdown(result)})
    for (const char* part : {"worse", "square × gd, seed 5", "loss", "+5 %"})
      EXPECT_TRUE(has(text, part)) << part << "\n" << text;
  const Json schema = read_json(kTree / "benchmarks/schemas/comparison.json");
  const Json json = parse_json(gate_json(result), "comparison");
  EXPECT_EQ(schema_violations(json, schema), std::vector<std::string>());
  EXPECT_EQ(json["tables"][0]["rows"][0][1], "square × gd, seed 5");
}

// Declared and undeclared minima, a second build, a cell in dispute, and what is no record.
TEST(Gate, AFolderReadRecordByRecordGivesTheCellsOfItsStudy) {
  const ResultFolder folder;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Record record = record_of({.seed = seed, .work_per_hit = 2});
    if (seed == 1) record.minimum.reset();
    if (seed == 1) record.hits.reset();
    folder.add(record);
    if (seed == 2) folder.add(record_of({.seed = 2, .work_per_hit = 3, .build = "b1"}));
    if (seed != 3) continue;
    end_at(record, record.summary.loss + 1);
    folder.add_file("runs/copy-of-3.json", file_text(record));
  }
  folder.add(record_of({.problem = "heat", .status = Status::inapplicable}));
  folder.add_file("runs/torn.json", "{");
  const Study study = read_study({folder.path()});
  const std::vector<ComparedCell> whole = compared_cells(study);
  const FolderCells found = read_cells(folder.path());
  EXPECT_EQ(found.superseded, study.superseded);
  ASSERT_EQ(found.unreadable.size(), 1U);
  EXPECT_TRUE(found.unreadable[0].file.ends_with("runs/torn.json"));
  EXPECT_EQ(compare_results(folder.path(), folder.path(), {}).unreadable.size(), 2U);
  ASSERT_EQ(found.cells.size(), whole.size());
  std::size_t doubtful = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const ComparedCell &a = whole[i], &b = found.cells[i];
    for (const auto text : {&ComparedCell::key, &ComparedCell::title, &ComparedCell::terms,
                            &ComparedCell::trace, &ComparedCell::rest, &ComparedCell::doubt})
      EXPECT_EQ(a.*text, b.*text);
    EXPECT_EQ(a.members, b.members);
    doubtful += !b.doubt.empty();
    ASSERT_EQ(a.figures.size(), b.figures.size());
    for (std::size_t q = 0; q < a.figures.size(); ++q)
      EXPECT_TRUE(a.has(q) ? a.figures[q] == b.figures[q] : !b.has(q)) << figure_name(q);
  }
  EXPECT_GE(doubtful, 1U) << "two records of one cell and build differ";
  EXPECT_THROW(read_cells("/nowhere/at/all"), UsageError);
}

// What stands under the name of a record costs itself: the comparison is that of all others.
TEST(Gate, ComparesAllThatCanBeReadBesidesWhatCannot) {
  const TwoFolders two;
  two.before.add(record_of({}));
  two.after.add(record_of({}));
  two.after.add_file("runs/huge.json", "[1e400]");
  ASSERT_EQ(mkfifo((two.after.path() / "runs" / "pipe.json").c_str(), 0600), 0);
  std::filesystem::create_symlink("circle.json", two.after.path() / "runs" / "circle.json");
  const GateResult result = two.compared();
  EXPECT_EQ(result.joined, 1U);
  EXPECT_EQ(result.equal, 1U);
  EXPECT_EQ(result.exit_code, kGood);
  ASSERT_FALSE(result.remarks.empty());
  EXPECT_TRUE(has(result.remarks[0], "3 files")) << result.remarks[0];
}

// What a comparison must not take at its word. A loss that a clock cut may be anything.
TEST(Doubt, ACellThatAClockCutIsNotComparableOrWorseByItsStatus) {
  const auto cut = [](Status status) {
    return compared([status](Record& record) {
      record.is_nondeterministic = true;
      record.status = status;
      end_at(record, record.summary.loss * 1e18);
    });
  };
  const GateResult same = cut(Status::budget);
  EXPECT_EQ(same.exit_code, kNotComparable);
  EXPECT_EQ(same.equal, 11U);
  ASSERT_EQ(same.incomparable.size(), 1U);
  EXPECT_TRUE(has(same.incomparable[0].reason, "NEW (budget)"));
  EXPECT_TRUE(has(same.verdict, "seed 5: ")) << same.verdict;
  const GateResult killed = cut(Status::timeout);
  EXPECT_EQ(killed.exit_code, kWorse);
  EXPECT_TRUE(has(killed.verdict, "status budget → timeout")) << killed.verdict;
}

TEST(Doubt, ATimeoutIsCutWhateverItsRecordSaysBesides) {
  const TwoFolders two;
  for (const ResultFolder* folder : {&two.before, &two.after})
    fill(*folder, {{5, ends_as(Status::timeout)}});
  EXPECT_EQ(two.compared().exit_code, kNotComparable);
}

TEST(Doubt, TwoRecordsOfOneCellAndBuildThatDifferAreNamedAndNotCompared) {
  const TwoFolders two;
  fill(two.before);
  fill(two.after);
  Record other = read_study({two.after.path()}).runs[5];
  other.repeat_wall_seconds = {0.3};
  two.after.add_file("runs/other.json", to_json(other).dump());
  EXPECT_EQ(two.compared().exit_code, kGood) << "other times alone";
  other.message = "another result";
  two.after.add_file("runs/other.json", to_json(other).dump());
  const GateResult result = two.compared();
  EXPECT_EQ(result.exit_code, kNotComparable);
  ASSERT_EQ(result.incomparable.size(), 1U);
  EXPECT_TRUE(result.incomparable[0].title.ends_with("seed 5"));
  EXPECT_TRUE(has(result.incomparable[0].reason, "two records of"));
}

// From 0 to 4.4e-15, twenty units in the last place of x = 1.
TEST(Doubt, RoundingOfAnErrorInXIsNoDifferenceWithinATolerance) {
  const auto with = [](Real before, Real after, Real scale, Real tolerance) {
    const TwoFolders two;
    for (const auto& [folder, x_error] : {std::pair(&two.before, before), {&two.after, after}})
      fill(*folder, {{5, [&](Record& record) {
                        end_in_x_at(record, x_error);
                        record.x_scale = scale;
                      }}});
    return two.compared({.tolerance = tolerance}).exit_code;
  };
  EXPECT_EQ(with(0, 4.4e-15, 1, 1e-6), kGood);
  EXPECT_EQ(with(0, 4.4e-15, 1e-9, 1e-6), kWorse) << "not where x is that small";
  EXPECT_EQ(with(0, 4.4e-9, 1, 1e-6), kWorse) << "nor where it is no rounding";
  EXPECT_EQ(with(1e-3, 1.1e-3, 1, 1e-6), kWorse);
}

// A start of 1e107 explains no difference of 1e90: rounding goes by the scale of the problem.
TEST(Doubt, RoundingGoesByTheScaleOfTheProblemNotByTheStart) {
  const TwoFolders two;
  for (const auto& [folder, loss] : {std::pair(&two.before, 0.07), {&two.after, 1e90}})
    fill(*folder, {{5, [&](Record& record) {
                      record.minimum.reset();
                      record.hits.reset();
                      record.scale = 10;
                      record.summary.start_loss = record.curve.loss[0] = 1e107;
                      end_at(record, loss);
                    }}});
  EXPECT_EQ(two.compared({.tolerance = 1e-6}).exit_code, kWorse);
}

TEST(Doubt, ATimeThatIsNotANumberIsLeftOut) {
  const TwoFolders two;
  for (const ResultFolder* folder : {&two.before, &two.after})
    fill(*folder, {{5, [](Record& record) {
                      record.repeat_wall_seconds = std::vector<Real>(10, 0.1);
                      record.repeat_wall_seconds.back() = std::nan("");
                    }}});
  const GateResult result = two.compared();
  EXPECT_EQ(result.exit_code, kGood);
  ASSERT_EQ(result.times.size(), 1U);
  EXPECT_EQ(result.times[0].n_before, 9U);
  EXPECT_TRUE(has(gate_terminal(result), "2 times omitted")) << gate_terminal(result);
}

// What NEW lacks is worse, unless a list that gives reasons allows it.
GateResult compared_without_adam(const AllowedList& allowed) {
  const TwoFolders two;
  fill(two.before, {"adam", "gd", "newton"}, as_it_was);
  fill(two.after, {"gd", "newton"}, as_it_was);
  return two.compared({.allowed = allowed});
}

TEST(Allowed, AnyCellMayBeMissingWhereCommonOnesAreCompared) {
  const ResultFolder all, some, empty;
  fill(all);
  some.add(read_study({all.path()}).runs[0]);
  EXPECT_EQ(compare_results(all.path(), some.path(), {}).only_before.size(), 11U);
  EXPECT_EQ(compare_results(all.path(), some.path(), {.is_common_only = true}).exit_code, 0);
  const GateResult grown = compare_results(some.path(), all.path(), {});
  EXPECT_EQ(grown.exit_code, 0);
  EXPECT_EQ(grown.only_after.size(), 11U);
  EXPECT_EQ(compare_results(all.path(), empty.path(), {.is_common_only = true}).exit_code, 4);
  EXPECT_THROW(compare_results(all.path(), "/no/such/folder", {}), UsageError);
}

TEST(Allowed, AMissingOptimizerIsWorseAndNamedInOneLine) {
  const GateResult result = compared_without_adam({});
  EXPECT_EQ(result.exit_code, kWorse);
  EXPECT_EQ(result.only_before.size(), 4U);
  EXPECT_TRUE(has(result.verdict, "NEW lacks 4 cells of adam")) << result.verdict;
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
  EXPECT_TRUE(has(gate_terminal(result), "* × gd, ")) << gate_terminal(result);
}

TEST(Allowed, AListOfAllowedCellsKeepsToItsSchemaAndGivesReasons) {
  const Json schema = read_json(kTree / "benchmarks/schemas/allowed.json");
  EXPECT_EQ(schema_violations(read_json(kTree / "benchmarks/baselines/allowed.json"), schema),
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

// Pairing of cells by what was asked, with changed defaults, and causes of differences.

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
    ASSERT_EQ(result.builds.size(), 1U);
    EXPECT_TRUE(has(result.builds[0], "optimizer's source (4 cells of gd ")) << result.builds[0];
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
  const std::string cells = cause_group_text(result.causes[0]);
  EXPECT_TRUE(cells.starts_with("240 cells of 40 ")) << cells;
  EXPECT_TRUE(cells.ends_with(": 240 not comparable")) << cells;
  const std::string text = gate_terminal(result);
  EXPECT_TRUE(text.starts_with("Comparison: not comparable")) << text;
  EXPECT_LE(lines_in(text), 36U) << text;
  EXPECT_TRUE(has(text, "; --all lists them")) << text;
  EXPECT_FALSE(has(gate_terminal(result, true), "; --all lists them"));
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
  EXPECT_TRUE(has(result.causes[1].cause, " harness "));
  EXPECT_EQ(cause_group_text(result.causes[1]), "3 cells of method-1 on sine: 3 better");
}

TEST(Causes, AnotherBudgetIsToldOnce) {
  const auto longer = [](Record& record) { record.request.budget.iterations = 77; };
  const GateResult result = compared(2, as_it_was, longer);
  EXPECT_EQ(result.exit_code, kWorse) << "NEW lacks the cells of BASE";
  EXPECT_TRUE(has(result.verdict, "(12 with another budget")) << result.verdict;
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
