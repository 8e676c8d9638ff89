// The page: medians to targets equal those of the tables, attributes of filters, fields, size.
#include "reports/page/page.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "core/files.h"
#include "core/json.h"
#include "core/oracle.h"
#include "core/results/advice.h"
#include "core/results/ranking.h"
#include "core/results/study.h"
#include "core/results/table.h"
#include "reports/report.h"
#include "reports/sections/figures.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// Three seeds, one of which stops at target 20: τ = 1e-4.
Study uneven_study(bool has_hits) {
  Study study;
  for (const std::uint64_t seed : {0, 1, 2}) {
    study.runs.push_back(record_of({.seed = seed,
                                    .hits = seed == 2 ? 21U : 51U,
                                    .work_per_hit = static_cast<std::int64_t>(2 + 2 * seed)}));
    if (!has_hits) study.runs.back().hits.reset();
  }
  return study;
}

TEST(Targets, AgreeWithTheTablesAtEachTolerance) {
  for (const bool has_hits : {true, false}) {
    const Study study = uneven_study(has_hits);
    const Comparison c = compare_optimizers(study);
    const Cell& cell = c.cell(0, 0);
    for (std::size_t t = 0; t < kTolerances.size(); ++t) {
      const Spread& work = cell.headline[t];
      const std::size_t hit = kTolerances[t].rung;
      EXPECT_EQ(cell.median(Measure::work, hit), work.median);
      const auto reached = std::ranges::count_if(
          c.runs, [hit](const reports::Run& run) { return run.targets.size() > hit; });
      EXPECT_EQ(static_cast<std::size_t>(reached), work.n - work.unsolved);
    }
  }
}

TEST(Targets, EndWhereTheMedianIsNeverReached) {
  Study study = uneven_study(true);
  study.runs[1].hits->iteration.at(10) = -1;  // two of three runs miss target 21
  study.runs[1].hits->work.at(10) = -1;
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(c.cell(0, 0).medians[0].size(), 21U);
  std::vector<std::size_t> reached;
  for (const reports::Run& run : c.runs) reached.push_back(run.targets.size());
  EXPECT_EQ(reached, (std::vector<std::size_t>{51, 10, 21}));
}

// By these attributes the page hides what is filtered out.
TEST(Page, RowsSectionsAndCellsNameWhatTheyAreAbout) {
  Study study;
  for (const char* problem : {"a", "b"})
    for (const char* optimizer : {"gd", "newton"})
      study.runs.push_back(record_of({.problem = problem, .optimizer = optimizer}));
  const std::string page = readable_html(document_of(compare_optimizers(study)));
  for (const char* part : {"<article class=\"problem one\" id=problem-1 data-p=1>",
                           "<article class=\"optimizer one\" id=optimizer-1 data-s=1>",
                           "<tr data-s=1 data-p=1><th scope=row>b", "<g data-s=1", "<tr data-s=1"})
    EXPECT_TRUE(has(page, part)) << part;
}

Json answer_in_page(const Record& record) {
  Study study;
  study.runs = {record};
  const Comparison c = compare_optimizers(study);
  const Json data = Json::parse(page_data(document_of(c), AllFields(1)));
  return data.at("problems").at(0).at("cells").at(0).at(6);
}

TEST(Page, HasTheFirstTwentyUnknownsOfARun) {
  constexpr std::size_t kUnknowns = 25;
  Record record = record_of({.seed = 3});
  record.status = Status::converged;  // else it has no deviations
  EXPECT_TRUE(answer_in_page(record).is_null());
  record.answer = AnswerPoints{.unknowns = kUnknowns,
                               .units = std::vector<std::string>(kUnknowns, "N/m"),
                               .points = {kReturned},
                               .x = {std::vector<Real>(kUnknowns, 0.5)},
                               .at_upper = {1},
                               .residual_norm = 0.25};
  record.uncertainty = Uncertainty{
      .x = {}, .standard_deviation = {0.125}, .correlation = {}, .degrees_of_freedom = 3};
  Json found = answer_in_page(record);
  EXPECT_EQ(found.at("seed"), 3);
  EXPECT_EQ(found.at("unknowns"), kUnknowns);
  EXPECT_EQ(found.at("norm"), "0.25");
  std::map<std::string, Json> columns;
  for (const Json& column : found.at("columns")) columns[column.at(0)] = column;
  EXPECT_EQ(columns.at("unknown").size(), 21U);
  EXPECT_EQ(columns.at("unknown").at(20), "x20");
  EXPECT_EQ(columns.at("unit").at(1), "N/m");
  EXPECT_EQ(columns.at("returned").at(1), "0.5");
  EXPECT_EQ(columns.at("standard deviation").at(1), "0.125");
  EXPECT_EQ(columns.at("active bound").at(1), "");
  EXPECT_EQ(columns.at("active bound").at(2), "upper");
  record.answer->digest = "0123456789abcdef";  // of many unknowns, which stand in a file
  found = answer_in_page(record);
  EXPECT_TRUE(found.at("columns").empty());
  EXPECT_TRUE(has(found.at("file").get<std::string>(), record.cell));
}

// Two labels of one method have one colour and one row of the audit. The page contains the method
// and does not parse the label.
TEST(Page, IsToldTheMethodOfEachOptimizer) {
  Record tuned = record_of({.optimizer = "gd[rate=0.5]"});
  tuned.request.rates = "learn-tuned.json";
  Study study;
  study.runs = {record_of({.optimizer = "gd[rate=0.1]"}), tuned};
  const Document document = document_of(compare_optimizers(study));
  EXPECT_TRUE(has(readable_html(document), "gd, tuned"));
  EXPECT_TRUE(has(page_data(document, AllFields(1)), "\"methods\":[\"gd\",\"gd\"]"));
  const std::filesystem::path scripts = ISOLINE_SOURCE_DIR "/reports/page";
  for (const auto& file : std::filesystem::directory_iterator(scripts)) {
    if (file.path().extension() != ".js") continue;
    for (const char* cut : {"split('[", "split(/[[", "indexOf('["})
      EXPECT_FALSE(has(read_text(file.path()), cut)) << file.path();
  }
}

TEST(Page, IsTitledByItsSuitesAndShowsFormulasAsTheyAreWritten) {
  Study study;
  study.runs = {record_of({})};
  study.plan.suites = {"quick"};
  study.sheets = {{.kind = "problem",
                   .name = "square",
                   .spec = "square",
                   .formula = "P(x) = x₁² / ‖x̃‖, Λ^(−κ) < 1",
                   .options_text = "[]"}};
  const std::string page = readable_html(document_of(compare_optimizers(study)));
  EXPECT_TRUE(has(page, "<title>quick"));
  EXPECT_TRUE(has(page, "<p class=formula>P(x) = x₁² / ‖x̃‖, Λ^(−κ) &lt; 1</p>"));
}

// The parser of a browser can pause between short elements, and holds ASCII in a byte a letter.
TEST(Page, IsSentInAsciiAndWaitsInShortPieces) {
  const Study study = uneven_study(true);
  const Document document = document_of(compare_optimizers(study));
  const std::string page = html_report(document), whole = readable_html(document);
  EXPECT_TRUE(std::ranges::all_of(page, [](char letter) { return letter > 0; }));
  EXPECT_FALSE(std::ranges::all_of(whole, [](char letter) { return letter > 0; }));
  EXPECT_TRUE(has(page, "&#10007;"));
  for (const char* waits : {"<table id=detail-table"})
    EXPECT_FALSE(has(page.substr(page.find("<section id=\"choose\"")), waits)) << waits;
  constexpr std::size_t kLongest = 32768;
  for (const char* name : {"data", "packs", "program"})
    EXPECT_TRUE(
        has(page, fmt::format("<script type=\"application/zlib\" id={0} class={0}>", name)));
  for (std::size_t at = 0; (at = page.find("<script", at)) != std::string::npos; ++at)
    EXPECT_LE(page.find('<', page.find('>', at)) - page.find('>', at), kLongest + 1);
}

TEST(Page, ShowsCodeBetweenBackticksAsCode) {
  EXPECT_EQ(prose_html("use `a<b` or `c`, or `d"),
            "use <code>a&lt;b</code> or <code>c</code>, or `d");
}

// A sheet names the least that a method can do with; the page names what its runs asked for.
TEST(Page, NamesTheDerivativesThatRunsCounted) {
  Study study;
  study.runs = {record_of({.problem = "a", .optimizer = "hig"}),
                record_of({.problem = "b", .optimizer = "hig"})};
  for (Record& record : study.runs) record.counts = {};
  for (Record& record : study.runs) record.counts[static_cast<std::size_t>(Oracle::forward)] = 11;
  study.runs[1].counts[static_cast<std::size_t>(Oracle::jacobian)] = 11;
  EXPECT_EQ(counted_oracles(compare_optimizers(study), 0), "forward, jacobian (on 1 of 2)");
}

// One line ends a hundred times below all others.
TEST(PanelsOfThePage, HaveNoAxisThatLeavesOutTheEndOfALine) {
  Study study;
  Figure figure{
      .problem = "square", .title = "5c", .kind = "curve", .is_log_x = true, .is_log_y = true};
  for (std::size_t s = 0; s < 5; ++s) {
    study.runs.push_back(record_of({.optimizer = "m" + std::to_string(s)}));
    figure.lines.push_back({.optimizer = s,
                            .x = {1, 10, 100},
                            .y = {3, 2, s == 0 ? 0.0124 : 1.3},
                            .low = {},
                            .high = {}});
  }
  Document document{.comparison = compare_optimizers(study)};
  document.figures = {figure};
  const std::string html = figures_html(document);
  const std::size_t at = html.find("data-y=\"");
  ASSERT_NE(at, std::string::npos);
  EXPECT_LE(std::stod(html.substr(at + 8)), 0.0124);
}

// Eight lines can be told apart; the others are shown on demand.
TEST(Page, ShowsEightLinesOfAProblemAtFirst) {
  Study study;
  for (std::size_t s = 0; s < 12; ++s) {
    const std::string name = "method-" + std::to_string(s);
    study.runs.push_back(record_of({.optimizer = name}));
    Sheet sheet{.kind = "optimizer", .name = name, .spec = name, .options_text = "[]"};
    sheet.mathematics = "kind-" + std::to_string(s);
    study.sheets.push_back(std::move(sheet));
  }
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(shown_at_first(c, ranking(c, 0)).size(), 8U);
  const auto count = [](const std::string& text, std::string_view part) {
    std::size_t all = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++all;
    return all;
  };
  const std::string own = curves_html(c, 0);
  EXPECT_EQ(count(own, "<g data-s="), 8U);
  EXPECT_EQ(count(own, "class=\"off\""), 0U) << "the data have them";
  const Json data = parse_json(curves_json(c, 0), "curves");
  EXPECT_EQ(data.at("rest").size(), 1 + count(data.at("charts"), "class=\"chart"));
  for (const auto& [name, lines] : data.at("rest").items())
    EXPECT_EQ(count(lines, "class=\"off\""), 4U) << name;
}

TEST(Page, TenThousandRecordsStayBelowEightMegabytes) {
  constexpr std::size_t kMost = 8'000'000, kProblems = 250, kOptimizers = 40;
  Study study;
  for (std::size_t p = 0; p < kProblems; ++p)
    for (std::size_t s = 0; s < kOptimizers; ++s)
      study.runs.push_back(record_of({.problem = "problem-" + std::to_string(p),
                                      .optimizer = "optimizer-" + std::to_string(s),
                                      .hits = 20 + (7 * p + 3 * s) % 32,
                                      .work_per_hit = static_cast<std::int64_t>(5 + p + 11 * s)}));
  EXPECT_EQ(study.runs.size(), 10'000U);
  EXPECT_LT(html_report(document_of(compare_optimizers(study))).size(), kMost);
}

// Rankings for each target and measure, brief labels, learned problems at equal work, kinds as
// colours.

const std::vector<Result> kThree = {
    {"a", "gd", 4},   {"a", "adam", 2}, {"a", "sip", 1},  {"b", "gd", 1},    {"b", "adam", 3},
    {"b", "sip", 0},  {"c", "gd", 5},   {"c", "adam", 5}, {"c", "sip", 2},   {"d", "gd", 2},
    {"d", "adam", 0}, {"d", "sip", 1},  {"e", "gd", 64},  {"e", "adam", 30}, {"e", "sip", 1}};

TEST(Ladders, AreTheStandingsOfTheReportAtItsTolerances) {
  const Study study = study_of(kThree);
  const Comparison c = compare_optimizers(study);
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    for (const Ranked& ranked : standings_to(c, Measure::work, kTolerances[t].rung)) {
      const Standing& own = c.optimizers[ranked.optimizer].standings[t];
      EXPECT_EQ(ranked.standing.score, own.score);
      EXPECT_EQ(ranked.standing.solved, own.solved);
      EXPECT_EQ(ranked.standing.wins, own.wins);
      EXPECT_EQ(ranked.standing.typical, own.typical);
      EXPECT_EQ(ranked.standing.reached, own.reached);
    }
}

TEST(Ladders, ByAnotherMeasureAreTheStandingsOfAReportByIt) {
  const Study study = study_of(kThree);
  const Comparison by_work = compare_optimizers(study);
  const Comparison by_time = compare_optimizers(study, yardstick_at(Measure::time, 1e-6));
  for (const Ranked& ranked : standings_to(by_work, Measure::time, kTolerances[kTightest].rung)) {
    const std::string& label = by_work.optimizers[ranked.optimizer].label;
    const auto same = std::ranges::find(by_time.optimizers, label, &OptimizerAxis::label);
    EXPECT_DOUBLE_EQ(ranked.standing.score, same->tightest().score) << label;
  }
}

TEST(Scores, StandWithinTheirIntervals) {
  const Study study = study_of(kThree);
  const Comparison c = compare_optimizers(study);
  const std::vector<Interval> intervals = score_intervals(c);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    EXPECT_LE(intervals[s].low, c.optimizers[s].tightest().score);
    EXPECT_GE(intervals[s].high, c.optimizers[s].tightest().score);
  }
}

// A setting to which one of two methods does not apply says nothing of the two.
TEST(MethodPairs, LeaveOutSettingsToWhichOneDoesNotApply) {
  Study study = study_of(kThree);
  const auto settings = [](const WorkRatio& ratio) {
    return ratio.both + ratio.only_a + ratio.only_b + ratio.neither;
  };
  const Comparison all = compare_optimizers(study);
  for (const MethodPair& pair : all_pairs(all)) EXPECT_EQ(settings(pair.ratio), 5U);
  for (Record& record : study.runs)
    if (record.request.problem.name == "e" && record.request.optimizer.name == "sip")
      record.status = Status::inapplicable;
  const Comparison c = compare_optimizers(study);
  for (const MethodPair& pair : all_pairs(c)) {
    const bool is_sip = c.optimizers[pair.a].label == "sip" || c.optimizers[pair.b].label == "sip";
    EXPECT_EQ(settings(pair.ratio), is_sip ? 4U : 5U);
  }
}

// gd takes gradients, newton Hessians, and simplex neither; sip has an inverse on some problems.
Study study_of_means() {
  Study study;
  const auto add = [&](const char* problem, const char* method, Oracle asked, std::int64_t work) {
    Record& record = study.runs.emplace_back(
        record_of({.problem = problem, .optimizer = method, .work_per_hit = work}));
    record.counts = {};
    record.counts[static_cast<std::size_t>(Oracle::forward)] = 1;
    record.counts[static_cast<std::size_t>(asked)] = 1;
    if (asked == Oracle::inverse)
      record.privileges = {std::string(name_of(Privilege::exact_inverse))};
  };
  for (const char* problem : {"a", "b", "c", "d", "e", "f"}) {
    study.sheets.push_back({.kind = "problem", .name = problem, .spec = problem, .unknowns = 20});
    add(problem, "simplex", Oracle::forward, 64);
    add(problem, "gd", Oracle::pullback, 16);
    add(problem, "newton", Oracle::hessian, 8);
    add(problem, "sip", *problem < 'd' ? Oracle::inverse : Oracle::pullback, 1);
  }
  return study;
}

TEST(Advice, RanksTheMethodsThatNeedNoMoreThanTheReaderHas) {
  const Study study = study_of_means();
  const Comparison c = compare_optimizers(study);
  const auto names = [&](const Means& means) {
    std::vector<std::string> all;
    for (const Advised& one : advise(c, means).ranked)
      all.push_back(c.optimizers[one.optimizer].method);
    return joined(all, " ");
  };
  using enum Derivatives;
  EXPECT_EQ(names({}), "simplex");
  EXPECT_EQ(names({.derivatives = gradient}), "gd simplex");
  EXPECT_EQ(names({.derivatives = hessian}), "newton gd simplex");
  EXPECT_EQ(names({.derivatives = gradient, .has_inverse = true}), "sip gd simplex");
  EXPECT_EQ(names({.least_unknowns = 21}), "");
  const Advice some = advise(c, {.derivatives = gradient});
  ASSERT_EQ(some.partial.size(), 1U);
  EXPECT_EQ(some.partial[0].settings, 3U);
  const Real most = c.cell(0, some.ranked[0].optimizer).median(Measure::work, 30);
  EXPECT_EQ(advise(c, {.derivatives = gradient, .budget = most}).ranked[0].solved, 6U);
  EXPECT_EQ(advise(c, {.derivatives = gradient, .budget = most}).ranked[1].solved, 0U);
  // Those that were run on all solve nothing, and one that was run on three does.
  const Advice short_of_work = advise(c, {.derivatives = gradient, .budget = most - 1});
  ASSERT_FALSE(short_of_work.ranked.empty());
  EXPECT_EQ(short_of_work.ranked[0].solved, 3U);
  EXPECT_EQ(c.optimizers[short_of_work.ranked[0].optimizer].method, "sip");
  EXPECT_EQ(short_of_work.settings.size(), 3U);
  EXPECT_EQ(short_of_work.of_size, 6U);
  EXPECT_TRUE(advise(c, {.budget = 1}).ranked.empty());
}

TEST(BriefLabels, ShowWhatDiffersAndNoTwoBecomeTheSame) {
  const std::vector<std::string> labels = {
      "adam",
      "gd[rate=0.1]",
      "sip[inverse=newton,network-optimizer=adam[rate=1e-3],proxy=l1]",
      "sip[inverse=analytic,network-optimizer=adam[rate=1e-3],proxy=l1]",
      "rescaled[by=truth,network-optimizer=adam[rate=1e-3]], tuned",
      "no[specification"};
  EXPECT_EQ(
      brief_labels(labels),
      (std::vector<std::string>{"adam", "gd[rate=0.1]", "sip[inverse=newton]",
                                "sip[inverse=analytic]", "rescaled, tuned", "no[specification"}));
  const std::vector<std::string> alike = {"rescaled[by=truth,network-optimizer=adam[rate=1e-3]]",
                                          "rescaled"};
  EXPECT_NE(brief_labels(alike)[0], brief_labels(alike)[1]);
}

Record learned(const char* optimizer, std::vector<std::int64_t> work, std::vector<Real> x_error) {
  Record record = record_of({.problem = "sine[mode=learn]", .optimizer = optimizer});
  record.request.problem.is_learned = true;
  record.curve = {};
  record.hits.reset();
  for (std::size_t i = 0; i < work.size(); ++i) {
    record.curve.iteration.push_back(static_cast<std::int64_t>(i));
    record.curve.work.push_back(work[i]);
    record.curve.wall_seconds.push_back(static_cast<Real>(i));
    record.curve.loss.push_back(x_error[i] / 2);
    record.curve.x_error.push_back(x_error[i]);
  }
  record.curve.processor_seconds = record.curve.gradient_norm = record.curve.step_norm =
      record.curve.wall_seconds;
  record.summary.work = work.back();
  record.summary.iterations = record.request.budget.iterations = record.curve.iteration.back();
  record.summary.x_error = x_error.back();
  return record;
}

// The errors in x of adam and sip at the least work that any method was allowed: at 200 adam has 2,
// at the end it would have 0.1. A run that failed before is infinite. One that diverged after two
// of six steps counts with its last finite value, is marked, and does not lower the common work.
TEST(EqualWork, IsTheLeastThatAnyMethodWasAllowed) {
  const struct {
    Record adam, sip;
    Status adam_ends, sip_ends;
    std::int64_t adam_steps, sip_steps;
    Real work, adam_error, sip_error;
  } cases[] = {{learned("adam", {0, 100, 200, 300}, {4, 3, 2, 0.1}),
                learned("sip", {0, 80, 160, 240}, {4, 2, 1, 0.5}), Status::budget, Status::budget,
                3, 3, 240, 2, 0.5},
               {learned("adam", {0, 100}, {4, 3}), learned("sip", {0, 50, 200}, {4, 2, 1}),
                Status::crashed, Status::budget, 3, 2, 0, kNever, 1},
               {learned("adam", {0, 100, 200, 300, 400, 500, 600}, {4, 3, 2, 1, 0.5, 0.3, 0.2}),
                learned("sip", {0, 90, 180}, {4, 2, NAN}), Status::budget, Status::diverged, 6, 6,
                540, 0.3, 2}};
  for (const auto& each : cases) {
    Study study;
    study.runs = {each.adam, each.sip};
    study.runs[0].status = each.adam_ends;
    study.runs[1].status = each.sip_ends;
    study.runs[0].request.budget.iterations = each.adam_steps;
    study.runs[1].request.budget.iterations = each.sip_steps;
    const Comparison c = compare_optimizers(study);
    const EqualWork equal = equal_work(c, 0);
    if (each.work > 0) {
      EXPECT_EQ(equal.work, each.work);
    }
    for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
      const bool is_sip = c.optimizers[s].label == "sip";
      EXPECT_EQ(equal.methods[s]->x_error.median, is_sip ? each.sip_error : each.adam_error);
      EXPECT_EQ(equal.methods[s]->diverged, is_sip && each.sip_ends == Status::diverged ? 1U : 0U);
    }
    const bool is_sip_nearest = each.sip_error < each.adam_error;
    EXPECT_EQ(c.optimizers[equal.nearest_first()[0]].label, is_sip_nearest ? "sip" : "adam");
  }
}

// A tolerance of the loss says little of a network.
TEST(Order, IsOfProblemsThatAreNotLearned) {
  Study study = study_of(kThree);
  study.runs.push_back(learned("adam", {0, 100}, {4, 3}));
  study.runs.push_back(learned("sip", {0, 50}, {4, 2}));
  const Comparison c = compare_optimizers(study);
  for (const std::size_t p : c.order.settings) EXPECT_FALSE(c.problems[p].is_learned);
  EXPECT_EQ(c.order.settings.size(), 5U);
}

// A colour is of a kind in every report; within it no two look alike.
TEST(Kinds, HaveOneColourAndTellTheirMethodsApart) {
  Comparison c;
  const Sheet adaptive{.kind = "optimizer", .name = "adam", .mathematics = "adaptive"};
  for (const char* label : {"adam", "adam, tuned", "adagrad", "lion", "shampoo", "adan"})
    c.optimizers.push_back({.label = label,
                            .method = std::string(label).substr(0, std::string(label).find(',')),
                            .sheet = &adaptive});
  c.optimizers.push_back({.label = "mine", .method = "mine"});
  std::set<std::string> looks;
  std::istringstream rules(kind_rules(c));
  std::string rule;
  for (std::size_t s = 0; s < c.optimizers.size() && std::getline(rules, rule);) {
    if (rule.starts_with("[data-look")) continue;  // the same by the name of the method
    EXPECT_NE(rule.find(++s < c.optimizers.size() ? "var(--adaptive)" : "var(--other)"),
              std::string::npos);
    looks.insert(rule.substr(rule.find('{')));
  }
  EXPECT_EQ(looks.size(), c.optimizers.size());
}

// The rules are of the form [data-s="0"]{--series:COLOUR;--dash:DASH}. A dash is of the method.
TEST(Kinds, HaveFiveMethodsOfWhichNoTwoShareAColour) {
  Comparison c;
  const Sheet adaptive{.kind = "optimizer", .name = "adam", .mathematics = "adaptive"};
  for (const char* label : {"adam", "adagrad", "lion", "shampoo", "adan"})
    c.optimizers.push_back({.label = label, .sheet = &adaptive});
  std::set<std::string> colours;
  std::istringstream rules(kind_rules(c));
  std::string rule;
  while (std::getline(rules, rule) && colours.size() < c.optimizers.size())
    if (rule.starts_with("[data-s"))
      colours.insert(rule.substr(rule.find('{'), rule.find(';') - rule.find('{')));
  EXPECT_EQ(colours.size(), c.optimizers.size());
}

// Eight lines that all end in the lower right corner.
TEST(PanelsOfThePage, NameTheEndsOfLinesWithinTheDrawingAndApart) {
  Drawing drawing{.plot = {.kind = Plot::Kind::lines, .is_log_y = true}, .has_names = true};
  for (int i = 0; i < 8; ++i)
    drawing.plot.series.push_back(
        {{}, "a long name of a method", {1, 2}, {1, 1e-12 * (1 + 1e-3 * i)}, {}, {}});
  const std::string svg = drawing_svg(drawing);
  const std::regex name("<text x=(\\d+) y=(\\d+) data-line"), size("viewBox=\"0 0 (\\d+) (\\d+)\"");
  std::smatch box;
  ASSERT_TRUE(std::regex_search(svg, box, size));
  std::vector<int> heights;
  for (std::sregex_iterator at(svg.begin(), svg.end(), name), none; at != none; ++at) {
    EXPECT_LE(std::stoi((*at)[1]) + 6 * 23, std::stoi(box[1]));
    EXPECT_LE(std::stoi((*at)[2]), std::stoi(box[2]) - 30) << "below the axis";
    heights.push_back(std::stoi((*at)[2]));
  }
  ASSERT_EQ(heights.size(), 8U);
  std::ranges::sort(heights);
  for (std::size_t i = 1; i < heights.size(); ++i) EXPECT_GE(heights[i] - heights[i - 1], 13) << i;
}

// Fields: the best of each kind, their captions, histories and bytes.

Sheet sheet_of(const char* kind, const std::string& name, const std::string& mathematics = "") {
  Sheet sheet{.kind = kind, .name = name, .spec = name, .options_text = "[]"};
  sheet.mathematics = mathematics;
  sheet.inverse = "none";
  return sheet;
}

class ShownFields : public testing::Test {
 protected:
  // x* is (1, 2), y* (4, 4), and a run goes from x = 0 to `end` times x*.
  void add(const char* optimizer, const char* kind, std::int64_t per_hit, float end,
           std::uint64_t seed = 0) {
    add_frames(
        optimizer, kind, per_hit,
        {.iterations = {0, 50}, .shape = {4, 1, 2}, .numbers = {4, 4, 1, 2, 0, 0, end, 2 * end}},
        seed);
  }
  void add_frames(const char* optimizer, const char* kind, std::int64_t per_hit, FieldFrames fields,
                  std::uint64_t seed = 0) {
    Record record = record_of(
        {.problem = "grid", .optimizer = optimizer, .seed = seed, .work_per_hit = per_hit});
    fields.digest = digest(field_file(fields));
    record.fields = fields;
    folder.add(record);
    write_text(field_path(folder.path() / "runs" / record.file_name()), field_file(fields));
    folder.add(sheet_of("optimizer", optimizer, kind));
    records.push_back(record);
  }
  std::optional<FoundFields> found(
      const Field& field = {.rows = 1, .columns = 2, .x = {"source", "1/m²"}, .y = {"potential"}}) {
    Sheet sheet = sheet_of("problem", "grid");
    sheet.field = field;
    folder.add(sheet);
    folder.add(plan_of(records));
    study = read_study({folder.path()});
    c = compare_optimizers(study);
    return found_fields(c, 0);
  }
  std::string name(const FoundField& one) const { return c.optimizers[one.optimizer].label; }

  ResultFolder folder;
  std::vector<Record> records;
  Study study;
  Comparison c;
};

TEST_F(ShownFields, AreOfTheBestOfEachKind) {
  add("slow", "gradient", 9, 0.5F);
  add("fast", "gradient", 2, 0.9F);
  add("newton", "second-order", 1, 1.0F);
  const auto all = found();
  ASSERT_TRUE(all);
  ASSERT_EQ(all->found.size(), 2U);
  EXPECT_EQ(name(all->found[0]), "newton");
  EXPECT_EQ(name(all->found[1]), "fast");
  EXPECT_EQ(all->x_scale, 2);
  EXPECT_EQ(all->y_scale, 4);
  EXPECT_EQ(all->x.unit, "1/m²");
  EXPECT_NEAR(all->found[1].apart[0], 1, 1e-7);  // ‖0 − x*‖ / ‖x*‖
  EXPECT_NEAR(all->found[1].apart[1], 0.1, 1e-6);
}

TEST_F(ShownFields, OfRunsThatKeptFewerStepsStandBesideTheOthers) {
  add("newton", "second-order", 1, 1.0F);
  add_frames("fast", "gradient", 2,
             {.iterations = {0}, .shape = {3, 1, 2}, .numbers = {4, 4, 1, 2, 0, 0}});
  const auto all = found();
  ASSERT_TRUE(all);
  EXPECT_EQ(all->found.size(), 2U);
  EXPECT_NE(fields_html(c, *all).find("&lt; 1e-7"), std::string::npos) << "of newton";
}

TEST_F(ShownFields, AreAllOfOneSeed) {
  add("newton", "second-order", 1, 1.0F, 3);
  add("fast", "gradient", 2, 0.9F, 0);
  const auto all = found();
  ASSERT_TRUE(all);
  EXPECT_EQ(all->seed, 3U);
  EXPECT_EQ(all->found.size(), 1U) << "that of seed 0 has another x*";
}

TEST_F(ShownFields, ThatAreDamagedGiveWayToTheNextOfTheirKind) {
  add("slow", "gradient", 9, 0.5F);
  add("fast", "gradient", 2, 0.9F);
  write_text(field_path(folder.path() / "runs" / records[1].file_name()), "damaged");
  const auto all = found();
  ASSERT_TRUE(all);
  EXPECT_EQ(name(all->found[0]), "slow");
  ASSERT_EQ(study.unreadable.size(), 1U);
  EXPECT_TRUE(study.unreadable[0].file.ends_with(".npy"));
}

TEST_F(ShownFields, WithoutAnyAreNothing) {
  records.push_back(record_of({.problem = "grid", .optimizer = "gd"}));
  folder.add(records[0]);
  EXPECT_FALSE(found());
}

TEST_F(ShownFields, StandInTheArticleWithTheirUnitsScaleAndWhatIsMissing) {
  add("fast", "gradient", 2, 0.9F);
  const auto all = found();
  ASSERT_TRUE(all);
  const std::string html = fields_html(c, *all);
  for (const char* words : {"<h4>Fields</h4>", "source, 1/m²", "−4 to 4", "potential", "x − x*",
                            "<output class=at>50</output>", "<output class=apart>= 0.1</output>",
                            "source, 1/m², from 0.9 to 1.8\""})
    EXPECT_NE(html.find(words), std::string::npos) << words << " in " << html;
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = html.find("<canvas ", at)) != std::string::npos; ++at) ++pictures;
  EXPECT_EQ(pictures, 5U) << "y*, x*, x, x − x* and the colours";
}

TEST_F(ShownFields, AreTheSameBytesInTheDataAndInThePictures) {
  add("fast", "gradient", 2, 0.9F);
  const auto all = found();
  ASSERT_TRUE(all);
  const Json json = parse_json(fields_json(*all), "fields");
  const auto& one = json.at("found").at(0);
  EXPECT_EQ(one.at("iterations"), Json({0, 50}));
  EXPECT_EQ(one.at("apart"), Json({"= 1", "= 0.1"}));
  EXPECT_EQ(one.at("x").at(1), letters_of(field_bytes({0.9F, 1.8F}, all->x_scale)));
  EXPECT_EQ(fields_html(c, *all).find(radix64(field_bytes({0.9F, 1.8F}, all->x_scale))),
            std::string::npos)
      << "they are not written twice";
}

// --- histories

const Field kHistory{
    .rows = 2, .columns = 1, .x = {"speed before"}, .y = {"speed after"}, .time = 0.5};

class ShownHistory : public ShownFields {
 protected:
  // x* = 1 becomes y* = 4, and x = ½ of it 3; of y* the last row alone is known.
  void SetUp() override {
    add_frames("fast", "gradient", 2,
               {.iterations = {7}, .shape = {3, 2, 1}, .numbers = {0, 4, 1, 4, 0.5F, 3}});
  }
};

TEST_F(ShownHistory, IsJudgedByItsFirstRowAndHasOneScale) {
  const auto all = found(kHistory);
  ASSERT_TRUE(all);
  EXPECT_TRUE(all->is_history());
  EXPECT_EQ(all->found[0].apart, std::vector<Real>{0.5});
  EXPECT_EQ(all->x_scale, 4);
  EXPECT_EQ(all->y_scale, 4);
}

TEST_F(ShownHistory, IsDrawnFromTheBottomAndSaysSo) {
  const auto all = found(kHistory);
  ASSERT_TRUE(all);
  const std::string html = fields_html(c, *all);
  for (const char* words :
       {"x* to y*", "x − x* to y − y*", "y at time 0.5", "speed before to speed after", "top row"})
    EXPECT_NE(html.find(words), std::string::npos) << words << " in " << html;
  const Json json = parse_json(fields_json(*all), "fields");
  EXPECT_EQ(json.at("truth"), letters_of("\xC0\x90")) << "y* = 4, above x* = 1";
  EXPECT_EQ(json.at("labels"), Json({"x to y", "x − x* to y − y*"}));
}

TEST_F(ShownHistory, OfOlderRunsThatKeptXAloneIsNone) {
  Field other = kHistory;
  other.rows = 14;
  const auto all = found(other);
  ASSERT_TRUE(all);
  EXPECT_FALSE(all->is_history());
}

// --- bytes

TEST(Radix64, IsThatOfTheStandard) {  // the test vectors of RFC 4648, section 10
  for (const auto& [bytes, text] :
       {std::pair("", ""), {"fo", "Zm8="}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}})
    EXPECT_EQ(radix64(bytes), text);
}

TEST(Cells, AreBytesAroundZeroUpToTwiceTheScale) {
  const std::vector<float> values = {0, 1, -1, 2, -2, 9, -9, 0.5F};
  const std::string bytes = field_bytes(values, 1);
  std::vector<int> found;
  for (const char byte : bytes) found.push_back(static_cast<unsigned char>(byte));
  EXPECT_EQ(found, (std::vector<int>{128, 192, 64, 255, 1, 255, 1, 160}));
  EXPECT_EQ(field_bytes({}, 1), "");
  EXPECT_EQ(static_cast<unsigned char>(field_bytes(values, 0)[1]), 128) << "all is zero";
}

}  // namespace
}  // namespace isoline::reports
