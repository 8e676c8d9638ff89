// Figures of the papers, tables of learned problems, plots and contours, from records made by hand.
#include "reports/sections/figures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>

#include "core/files.h"
#include "core/json.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"
#include "tests/reports/synthetic.h"

namespace isoline::reports {
namespace {

struct Learned {
  Real xi = 1;
  std::string optimizer;
  std::uint64_t seed = 0;
  Real x_error = 1, loss = 1;
};

Record learned(const Learned& given) {
  const std::string spec = "sine[xi=" + std::to_string(static_cast<int>(given.xi)) + ",mode=learn]";
  Record record = record_of({.problem = spec, .optimizer = given.optimizer, .seed = given.seed});
  record.request.problem.name = "sine";
  record.request.problem.options = {{"mode", "learn"}, {"xi", given.xi}, {"phi", 45}};
  record.request.problem.is_learned = true;
  record.curve.x_error.assign(record.curve.iteration.size(), given.x_error);
  record.summary.start_x_error = record.summary.x_error = given.x_error;
  record.curve.loss.back() = record.summary.loss = given.loss;
  record.summary.best_loss = std::ranges::min(record.curve.loss);
  record.cell = digest(spec + given.optimizer + std::to_string(given.seed));
  return record;
}

Sheet sine_sheet(std::vector<Panel> panels) {
  return {.kind = "problem",
          .name = "sine",
          .spec = "sine[xi=1,mode=learn]",
          .options_text = "[]",
          .inverse = "exact",
          .panels = std::move(panels)};
}

std::vector<Figure> drawn(const std::vector<Record>& records, const Panel& panel) {
  return figures(Compared(Study{.runs = records, .sheets = {sine_sheet({panel})}}));
}

// The median over seeds over ξ, divided by ξ: by hand 2/1, 8/2, 12/4.
TEST(Figures, SweepIsTheMedianErrorAtTheEndOverTheOption) {
  std::vector<Record> records;
  for (const auto& [xi, errors] :
       std::map<Real, std::vector<Real>>{{1, {1, 2, 9}}, {2, {8, 7, 9}}, {4, {12, 12, 10}}})
    for (std::size_t seed = 0; seed < errors.size(); ++seed)
      records.push_back(
          learned({.xi = xi, .optimizer = "sip", .seed = seed, .x_error = errors[seed]}));
  const auto all =
      drawn(records, {.title = "5d", .kind = "sweep", .over = "xi", .divided_by = "xi"});
  ASSERT_EQ(all.size(), 1U);
  ASSERT_EQ(all[0].lines.size(), 1U);
  EXPECT_EQ(all[0].lines[0].x, (std::vector<Real>{1, 2, 4}));
  EXPECT_EQ(all[0].lines[0].y, (std::vector<Real>{2, 4, 3}));
  EXPECT_EQ(all[0].lines[0].low, (std::vector<Real>{1, 3.5, 2.5}));
  EXPECT_EQ(all[0].lines[0].high, (std::vector<Real>{9, 4.5, 3}));
}

TEST(Figures, CurveTakesOnlyTheProblemsThatItsPanelWants) {
  const std::vector<Record> records = {learned({.xi = 1, .optimizer = "sip", .x_error = 2}),
                                       learned({.xi = 1, .optimizer = "adam", .x_error = 6}),
                                       learned({.xi = 32, .optimizer = "sip", .x_error = 3})};
  const auto all = drawn(records, {.title = "5b", .kind = "curve", .where = {{"xi", 1}}});
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].lines.size(), 2U);
  EXPECT_TRUE(has(all[0].reading, "sip has 2")) << all[0].reading;
  EXPECT_TRUE(has(all[0].reading, "adam 6")) << all[0].reading;
}

TEST(Figures, ScatterAndDecadesReadTheSamples) {
  Record record = learned({.optimizer = "sip"});
  record.exhibit = Exhibit{.target = {}, .x = {}, .truth = {}};
  record.exhibit->target = Grid(1, 6, std::vector<Real>(6, 0.02));
  record.exhibit->truth = Grid(1, 6, {-5, -4, -3, -2, -1, 0});
  record.exhibit->x = Grid(1, 6, {-4.5, -3.5, -2.5, -1.5, -0.5, 0.5});
  const auto scatter = drawn({record}, {.title = "2", .kind = "scatter"});
  ASSERT_EQ(scatter.size(), 1U);
  EXPECT_EQ(scatter[0].lines[0].x.size(), 6U);
  EXPECT_TRUE(has(scatter[0].reading, "sip 0.5")) << scatter[0].reading;
  const auto decades = drawn({record}, {.title = "2", .kind = "decades"});
  ASSERT_GE(decades.size(), 1U);
}

TEST(Figures, PicturesAreReadFromTheFileBesideTheRecord) {
  Record record = learned({.optimizer = "sip"});
  FieldFrames fields{.iterations = {0, 9}, .shape = {5, 2, 2}};
  fields.numbers = {1, 3, 2, 4, 9, 11, 10, 12, 0, 0, 0, 0, 5, 7, 6, 8,  // y*, x*, x at 0 and at 9
                    2, 3, 2, 3};                                        // and y at 9
  fields.digest = digest(field_file(fields));
  record.fields = fields;
  record.cell = cell_digest(record.request);
  const ResultFolder folder;
  folder.add(record);
  folder.add(sine_sheet({{.title = "6", .kind = "pictures"}}));
  write_text(field_path(folder.path() / "runs" / record.file_name()), field_file(fields));
  const auto all = figures(Compared(read_study({folder.path()})));
  ASSERT_EQ(all.size(), 1U);
  ASSERT_EQ(all[0].pictures.size(), 4U);
  EXPECT_EQ(all[0].pictures[0].values, (std::vector<Real>{1, 3, 2, 4}));  // rows of the picture
  EXPECT_EQ(all[0].pictures[1].title, "x, sip");
  EXPECT_EQ(all[0].pictures[1].values, (std::vector<Real>{5, 7, 6, 8}))
      << "x at the last iteration";
  EXPECT_EQ(all[0].pictures[2].title, "y, sip");
  EXPECT_EQ(all[0].pictures[2].values, (std::vector<Real>{2, 3, 2, 3}));
  EXPECT_EQ(all[0].pictures[3].values, (std::vector<Real>{9, 11, 10, 12}));
}

TEST(Figures, LearnedTablesNameWhereLossAndErrorRankDifferently) {
  const std::vector<Record> records = {
      learned({.xi = 1, .optimizer = "sip", .x_error = 1, .loss = 1}),
      learned({.xi = 1, .optimizer = "adam", .x_error = 2, .loss = 2}),
      learned({.xi = 32, .optimizer = "sip", .x_error = 1, .loss = 5}),
      learned({.xi = 32, .optimizer = "adam", .x_error = 2, .loss = 3})};
  const Compared comparison(records);
  const std::vector<Table> all = learned_section(comparison).tables;
  ASSERT_EQ(all.size(), 2U);
  EXPECT_TRUE(has(all[0].reading, "sip has both"));
  EXPECT_TRUE(has(all[1].reading, "rank methods differently"));
  EXPECT_NE(markdown_report(document_of(comparison)).find(all[1].reading.substr(0, 40)),
            std::string::npos);
}

// Heat maps of two options, and spectra.

struct Swept {
  Real kappa = 0.5, rate = 1, loss = 1;
  Index batch = 32;
  std::int64_t iterations = 100;
  std::uint64_t seed = 0;
  std::string inner = "";
};

Record swept(const Swept& given) {
  const std::string name = std::to_string(given.kappa) + " " + std::to_string(given.rate) + " " +
                           std::to_string(given.batch) + given.inner;
  Record record = record_of({.problem = "chain[batch=" + std::to_string(given.batch) + "]",
                             .optimizer = "hig[" + name + "]",
                             .seed = given.seed});
  record.request.problem.name = "chain";
  record.request.problem.options = {{"batch", given.batch}};
  record.request.optimizer.name = "hig";
  record.request.optimizer.options = {{"kappa", given.kappa}, {"rate", given.rate}};
  if (!given.inner.empty()) record.request.optimizer.options.set("network-optimizer", given.inner);
  record.request.budget.iterations = given.iterations;
  record.curve.loss.back() = record.summary.loss = given.loss;
  record.summary.best_loss = std::ranges::min(record.curve.loss);
  record.cell = digest(name + std::to_string(given.iterations) + std::to_string(given.seed));
  return record;
}

TEST(Sweeps, DrawTheMediansOverSeedsOfAllThatDiffersInTwoOptions) {
  std::vector<Record> records;
  for (const Real kappa : {0.5, 1.0})
    for (const Real rate : {0.1, 1.0, 10.0})
      for (const std::uint64_t seed : {0, 1, 2})
        records.push_back(swept({.kappa = kappa,
                                 .rate = rate,
                                 .loss = kappa * (1 + std::abs(std::log10(rate))) + Real(seed),
                                 .seed = seed}));
  records.push_back(swept({.rate = 100, .iterations = 7}));  // of another length
  const Section section = sweeps_section(Compared(records));
  ASSERT_EQ(section.tables.size(), 1U);
  const Table& map = section.tables[0];
  EXPECT_EQ(map.title, "hig on chain: kappa × rate");
  EXPECT_EQ(map.columns, (std::vector<std::string>{"kappa / rate", "0.1", "1", "10"}));
  EXPECT_EQ(map.rows[0][2].text, "1.5") << "the median over seeds, of κ = ½ and η = 1";
  EXPECT_EQ(map.rows[0][2].shade, 0);
  EXPECT_TRUE(map.rows[0][2].is_best);
  EXPECT_EQ(map.rows[1][0].text, "1");
  EXPECT_EQ(map.rows[1][1].text, "3");
  EXPECT_EQ(map.rows[1][1].shade, 1) << "within a factor 2";
  for (const char* part : {" 1.5", "kappa = 0.5", "rate = 1;", "6 of 6 settings"})
    EXPECT_TRUE(has(map.reading, part)) << part;
  EXPECT_TRUE(has(map.caption, "3 seeds, 100 iterations"));
}

TEST(Sweeps, CountWhatDivergedAsInfinite) {
  std::vector<Record> records;
  for (const Real kappa : {0.5, 1.0})
    for (const Real rate : {0.1, 1.0, 10.0})
      records.push_back(swept({.kappa = kappa,
                               .rate = rate,
                               .loss = rate > 1 ? std::numeric_limits<Real>::quiet_NaN() : rate}));
  const Section section = sweeps_section(Compared(records));
  EXPECT_EQ(section.tables.at(0).rows[0][3].text, "✗");
  EXPECT_FALSE(section.tables[0].rows[0][3].shade);
  EXPECT_EQ(section.tables[0].rows[0][1].shade, 0);
}

TEST(Sweeps, OfFewCellsOrOfOneOptionAreNoGrid) {
  std::vector<Record> records;
  for (const Real rate : {0.1, 1.0, 10.0, 100.0}) records.push_back(swept({.rate = rate}));
  records.push_back(swept({.kappa = 1, .rate = 1}));  // 5 of 8 cells
  EXPECT_TRUE(sweeps_section(Compared(records)).is_empty());
}

TEST(Sweeps, OfBatchesCompareEqualNumbersOfSamples) {
  std::vector<Record> records;
  for (const Index batch : {4, 8})
    for (const Real rate : {0.1, 1.0, 10.0})
      records.push_back(swept({.rate = rate, .batch = batch, .iterations = 1024 / batch}));
  const Section section = sweeps_section(Compared(records));
  ASSERT_EQ(section.tables.size(), 1U);
  EXPECT_EQ(section.tables[0].columns[0], "batch / rate");
  EXPECT_TRUE(has(section.tables[0].caption, "1024 samples each"));
}

TEST(Sweeps, SeeOptionsOfWhatStandsInside) {
  std::vector<Record> records;
  for (const Real kappa : {0.5, 1.0})
    for (const char* inner : {"adam[rate=1e-4]", "adam[rate=1e-3]", "adam[rate=1e-2]"})
      records.push_back(swept({.kappa = kappa, .inner = inner}));
  const Section section = sweeps_section(Compared(records));
  ASSERT_EQ(section.tables.size(), 1U);
  EXPECT_EQ(section.tables[0].columns,
            (std::vector<std::string>{"kappa / network-optimizer.rate", "1e-4", "0.001", "0.01"}));
}

TEST(Sweeps, SpectraShowWhatTheStartSeesAndWhatStepsMakeOfIt) {
  Record record = record_of({.problem = "square", .optimizer = "gd"});
  record.spectrum = {.iterations = {0, 1}, .sigma = {{10, 1, 1e-7}, {20, 4, 2}}};
  const Section section = spectra_section(Compared({record}));
  ASSERT_EQ(section.plots.size(), 2U);
  EXPECT_TRUE(has(section.plots[0].reading, " 2 of 3 "));
  EXPECT_TRUE(has(section.plots[0].reading, " of gd, 3."));
  EXPECT_EQ(section.plots[0].series.size(), 2U);
  EXPECT_EQ(section.plots[0].series[1].y, (std::vector<Real>{20, 4, 2}));
  EXPECT_TRUE(has(section.plots[1].reading, "From 1e8 "));
  EXPECT_TRUE(has(section.plots[1].reading, " to 10 "));
  for (const Plot& plot : section.plots) {
    EXPECT_TRUE(plot.is_log_x && plot.is_log_y) << plot.id;
    EXPECT_TRUE(has(plot.caption, "norm")) << plot.id << " names none";
  }
}

TEST(Sweeps, SpectraOfNoNumbersAreNotDrawn) {
  Record none = record_of({.problem = "square", .optimizer = "gd"});
  none.spectrum = Spectrum{};
  Record zero = record_of({.problem = "square", .optimizer = "adam"});
  zero.spectrum = {.iterations = {0}, .sigma = {{0, 0}}};
  EXPECT_TRUE(spectra_section(Compared({none, zero})).is_empty());
}

// Plots of the statistics: numbers computed by hand, and alternatives in text.

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

// Six problems sampled with replacement: the chance that at most one is of the four on which a is
// best is 1.8 %, that at most two are, 10 %, that all six are, 9 %. So 95 % reach from 1/3 to 1.
TEST(Plots, BandsAreThoseOfResampledProblems) {
  const Study study = study_of({{"p", "a", 1},
                                {"p", "b", 2},
                                {"q", "a", 1},
                                {"q", "b", 8},
                                {"r", "a", 1},
                                {"r", "b", 16},
                                {"s", "a", 0},
                                {"s", "b", 1},
                                {"t", "a", 1},
                                {"t", "b", 2},
                                {"u", "a", 3},
                                {"u", "b", 1}});
  const Plot plot = profile_plot(compare_optimizers(study)).at(0);
  EXPECT_NEAR(plot.series[0].low[0], 1.0 / 3, 1e-12);
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
  const std::string page = readable_html(document);
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
  const Json report = parse_json(json_report(document), "report");
  const std::vector<Plot>& plots = document.section("statistics").plots;
  Json written = Json::array();
  for (const Json& plot : report.at("plots"))
    if (std::ranges::find(plots, plot.at("id").get<std::string>(), &Plot::id) != plots.end())
      written.push_back(plot);
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

// Marching squares on shapes whose isolines are known.

Landscape sampled(int n, const std::function<Real(Real, Real)>& loss) {
  Landscape landscape{{-2, 2, -2, 2}, Grid(n, n)};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      landscape.loss(i, j) = loss(-2 + 4.0 * i / (n - 1), -2 + 4.0 * j / (n - 1));
  return landscape;
}

Real length_of(const PlotSeries& line) {
  Real length = 0;
  for (std::size_t i = 1; i < line.x.size(); ++i)
    if (const Real piece = std::hypot(line.x[i] - line.x[i - 1], line.y[i] - line.y[i - 1]);
        std::isfinite(piece))
      length += piece;
  return length;
}

TEST(Contour, OfABowlIsACircle) {
  const Landscape bowl = sampled(101, [](Real a, Real b) { return a * a + b * b; });
  const PlotSeries line = isoline(bowl, 1.5);
  const Real radius = std::sqrt(1.5), h = 0.04;
  // Linear interpolation of r² along an edge of length h errs by at most h²/8 · 2 in r².
  for (std::size_t i = 0; i < line.x.size(); ++i)
    if (!std::isnan(line.x[i])) {
      EXPECT_NEAR(std::hypot(line.x[i], line.y[i]), radius, h * h / (8 * radius));
    }
  EXPECT_NEAR(length_of(line), 2 * std::numbers::pi * radius, 0.01);
}

TEST(Contour, OfASlopeIsALineFromEdgeToEdge) {
  const PlotSeries line = isoline(sampled(5, [](Real a, Real) { return a; }), 0.5);
  EXPECT_EQ(line.x.size(), 5U) << "four segments, joined";
  EXPECT_NEAR(length_of(line), 4, 1e-12);
  for (const Real x : line.x) EXPECT_TRUE(std::isnan(x) || std::abs(x - 0.5) < 1e-12);
}

TEST(Contour, OfASaddleNeverCrossesItself) {
  const PlotSeries line = isoline(sampled(4, [](Real a, Real b) { return a * b; }), 0.1);
  for (std::size_t i = 1; i < line.x.size(); ++i)
    EXPECT_FALSE(line.x[i] * line.x[i - 1] < 0) << "each segment keeps to its quadrant";
}

TEST(Contour, LeavesOutWhatIsNotFinite) {
  Landscape holed = sampled(21, [](Real a, Real b) { return a * a + b * b; });
  const Real whole = length_of(isoline(holed, 1));
  holed.loss(10, 15) = NAN;
  const PlotSeries line = isoline(holed, 1);
  EXPECT_LT(length_of(line), whole);
  EXPECT_GT(length_of(line), whole / 2);
  EXPECT_EQ(std::ranges::count_if(line.x, [](Real x) { return std::isnan(x); }), 0)
      << "what is left is one line";
}

TEST(Contour, LevelsAreThoseOfTheFigures) {
  Landscape bowl = sampled(11, [](Real a, Real b) { return a * a + b * b; });
  bowl.spacing = "powers of two";
  const auto powers = contour_levels(bowl);  // 2^i, i = −5 … 7
  ASSERT_EQ(powers.size(), 13U);
  EXPECT_DOUBLE_EQ(powers.front(), 1 / 32.0);
  EXPECT_DOUBLE_EQ(powers.back(), 128);
  bowl.spacing = "fifth root";
  const auto roots = contour_levels(bowl);
  EXPECT_NEAR(std::pow(roots[2], 0.2) - std::pow(roots[1], 0.2), std::pow(roots[0], 0.2), 1e-12);
}

}  // namespace

// An older record, which judged x at its stored points alone, without those of iterations 11 to 29.
TEST(Lines, AreDashedWhereNoPointIsStoredAndSayWhereTheTableCountsAtMost) {
  Record record = record_of({});
  record.aim = Aim::x;
  record.x_scale = 1;
  const Compared whole({record});
  for (auto* column : {&record.curve.iteration, &record.curve.work})
    column->erase(column->begin() + 11, column->begin() + 30);
  for (auto* column :
       {&record.curve.wall_seconds, &record.curve.processor_seconds, &record.curve.loss,
        &record.curve.x_error, &record.curve.gradient_norm, &record.curve.step_norm})
    column->erase(column->begin() + 11, column->begin() + 30);
  const Compared sparse({record});
  const auto gaps = [](const Compared& c) {
    return std::ranges::count_if(own_curves(c, 0)->plot.series.at(0).y,
                                 [](Real y) { return std::isnan(y); });
  };
  EXPECT_EQ(gaps(whole), 0);
  EXPECT_EQ(gaps(sparse), 1);
  for (const char* mark : {"class=gap", "data-bound", ">≤ gd<"}) {
    EXPECT_FALSE(has(curves_html(whole, 0), mark)) << mark;
    EXPECT_TRUE(has(curves_html(sparse, 0), mark)) << mark;
  }
}

}  // namespace isoline::reports
