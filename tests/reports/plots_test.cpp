// The plots of the statistics: hand-computed numbers, and figures that every reader can use.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/json.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"
#include "tests/reports/synthetic.h"

namespace isoline::reports {
namespace {

// a is best on p, q and r; b is two, four and sixteen times as dear there, and alone on s.
const Study& four_problems() {
  static const Study study = study_of({{"p", "a", 1},
                                       {"p", "b", 2},
                                       {"q", "a", 1},
                                       {"q", "b", 4},
                                       {"r", "a", 1},
                                       {"r", "b", 16},
                                       {"s", "a", 0},
                                       {"s", "b", 1}});
  return study;
}

Real height(const PlotSeries& line, Real x) {
  Real y = -1;
  for (std::size_t i = 0; i < line.x.size() && line.x[i] <= x * (1 + 1e-9); ++i) y = line.y[i];
  return y;
}

TEST(Plots, ProfilesAreThoseOfTheComparison) {
  const Comparison c = compare_optimizers(four_problems());
  const Plots plots = profile_plot(c);
  ASSERT_EQ(plots.size(), 1U);
  const Plot* plot = &plots[0];
  ASSERT_EQ(plot->series.size(), 2U);
  EXPECT_EQ(height(plot->series[0], 1), 0.75);
  EXPECT_EQ(height(plot->series[0], 64), 0.75);
  EXPECT_EQ(height(plot->series[1], 1), 0.25);
  EXPECT_EQ(height(plot->series[1], 2), 0.5);
  EXPECT_EQ(height(plot->series[1], 3.9), 0.5);
  EXPECT_EQ(height(plot->series[1], 8), 0.75);
  EXPECT_EQ(height(plot->series[1], 16), 1);
  for (const PlotSeries& line : plot->series)
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      EXPECT_EQ(line.y[i], c.profiles[kTightest].share(*line.optimizer, line.x[i]));
      EXPECT_LE(line.low[i], line.y[i]);
      EXPECT_GE(line.high[i], line.y[i]);
    }
}

// Four problems drawn with replacement: the chance that none is one of the three on which a is best
// is 4⁻⁴ = 0.4 %, that at most one is, 5 %, that all four are, 32 %. So 95 % reach from ¼ to 1.
TEST(Plots, BandsAreThoseOfProblemsDrawnAnew) {
  const Plot plot = profile_plot(compare_optimizers(four_problems())).at(0);
  EXPECT_EQ(plot.series[0].low[0], 0.25);
  EXPECT_EQ(plot.series[0].high[0], 1);
}

// Work 30, 30, 30 of a: nothing within 10 forward solves, three of four within 100.
TEST(Plots, DataProfilesCountForwardSolves) {
  const Plot plot = data_profile_plot(compare_optimizers(four_problems())).at(0);
  EXPECT_EQ(height(plot.series[0], 10), 0);
  EXPECT_EQ(height(plot.series[0], 100), 0.75);
}

// Of two seeds one meets target j at 2 j, the other the first ten of 51 alone, and stops after 20.
TEST(Plots, RuntimesRestartUntilTheTargetIsMet) {
  Study study;
  study.runs = {record_of({.seed = 0, .work_per_hit = 2}),
                record_of({.seed = 1, .hits = 10, .work_per_hit = 2, .status = Status::budget})};
  const Plot plot = runtime_plot(compare_optimizers(study)).at(0);
  const PlotSeries& line = plot.series[0];
  // After k bad attempts, each with chance ½, target j is met at 20 k + 2 j.
  Real expected = 10;
  for (int j = 10; j <= 50; ++j)
    for (int k = 0; 20 * k + 2 * j <= 100; ++k) expected += std::pow(0.5, k + 1);
  // Of 1,000 draws the share of each target has a standard error of at most 0.016; three of them.
  EXPECT_NEAR(height(line, 100), expected / 51, 0.05);
  EXPECT_NEAR(height(line, 1e9), 1, 1e-3);
  EXPECT_NEAR(height(line, 10), 6 / 51.0, 1e-12);  // targets 0 … 5, at 2 j
  EXPECT_EQ(height(runtime_plot(compare_optimizers(four_problems())).at(0).series[1], 1e9), 1);
}

TEST(Plots, AreFiguresForEveryReader) {
  const ResultFolder folder;
  write_synthetic_study(
      folder.path(), {.problems = 8, .optimizers = 9, .seeds = 3, .points = 30, .is_sample = true});
  const Study study = read_study({folder.path()});
  const Document document = document_of(compare_optimizers(study));
  const Comparison& c = document.comparison;
  const Section& section = document.section("statistics");
  ASSERT_GE(section.plots.size(), 3U);
  const std::string page = html_report(document);
  static const std::regex subject("data-s=([0-9]+)"), place("data-p=([0-9]+)"), wild("nan|inf");
  for (const Plot& plot : section.plots) {
    const std::string html = plot_html(plot);
    const std::string svg =
        html.substr(html.find("<svg"), html.rfind("</svg>") - html.find("<svg"));
    EXPECT_FALSE(plot.reading.empty()) << plot.id;
    EXPECT_NE(plot.caption.find("fail"), std::string::npos) << plot.id << ": " << plot.caption;
    EXPECT_NE(svg.find("role=img aria-label=\""), std::string::npos) << plot.id;
    EXPECT_NE(svg.find("<title>"), std::string::npos) << plot.id;
    EXPECT_FALSE(
        std::regex_search(std::regex_replace(svg, std::regex("<title>[^<]*|\"[^\"]*\""), ""), wild))
        << plot.id;
    const auto below = [&](const std::regex& what, std::size_t count) {
      for (std::sregex_iterator it(svg.begin(), svg.end(), what), end; it != end; ++it)
        EXPECT_LT(std::stoul((*it)[1]), count) << plot.id;
    };
    below(subject, c.optimizers.size());
    below(place, c.problems.size());
    EXPECT_TRUE(std::regex_search(svg, subject) || std::regex_search(svg, place)) << plot.id;
    EXPECT_NE(page.find(svg), std::string::npos) << plot.id;
  }
}

TEST(Plots, HaveTheirNumbersInTheReport) {
  const Document document = document_of(compare_optimizers(four_problems()));
  const Json written = parse_json(json_report(document), "report").at("statistics").at("plots");
  const std::vector<Plot>& plots = document.section("statistics").plots;
  ASSERT_EQ(written.size(), plots.size());
  for (std::size_t i = 0; i < plots.size(); ++i)
    for (std::size_t s = 0; s < plots[i].series.size(); ++s)
      for (std::size_t k = 0; k < plots[i].series[s].y.size(); ++k) {
        const Real drawn = plots[i].series[s].y[k];
        if (std::isnan(drawn)) continue;
        EXPECT_EQ(real_of(written[i].at("series")[s].at("y")[k]), drawn) << plots[i].id;
      }
}

TEST(Plots, OfNothingAreNone) {
  const Study none;
  EXPECT_TRUE(statistics_section(compare_optimizers(none)).plots.empty());
}

// Where ends are equal but for their last bits, or are none at all, a step is lost to rounding.
TEST(Plots, HaveAxesOfFewTicksWhateverTheirEnds) {
  const Real last = std::nextafter(1.0, 2.0);
  for (const auto& [low, high] :
       {std::pair{1.0, last}, std::pair{1e17, 1e17 + 16}, std::pair{-last, -1.0},
        std::pair{0.0, 1e-320}, std::pair{0.0, 1.0}, std::pair{1e-300, 1e300}})
    for (const bool is_logarithmic : {false, true})
      EXPECT_LE(ticks_of(low, high, is_logarithmic).size(), 64U) << low << " to " << high;
  EXPECT_EQ(ticks_of(0, 10, false).size(), 6U);  // 0, 2, … 10
  Frame frame;
  frame.window.y_low = 0;
  frame.window.y_high = 5e-324;
  frame.is_log_y = true;
  EXPECT_LT(y_axis(frame, "", false).size(), 10000U);
}

}  // namespace
}  // namespace isoline::reports
