// The papers' figures and the tables of learned problems, from records made by hand.
#include "reports/sections/figures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/files.h"
#include "core/json.h"
#include "reports/report.h"
#include "tests/reports/fixture.h"

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
  EXPECT_TRUE(has(all[0].reading, "adam 6 (3×)")) << all[0].reading;
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
  FieldFrames fields{.iterations = {0, 9}, .shape = {4, 2, 2}};
  fields.numbers = {1, 3, 2, 4, 9, 11, 10, 12, 0, 0, 0, 0, 5, 7, 6, 8};  // y*, x*, x at 0 and at 9
  fields.digest = digest(field_file(fields));
  record.fields = fields;
  const ResultFolder folder;
  folder.add(record);
  folder.add(sine_sheet({{.title = "6", .kind = "pictures"}}));
  write_text(field_path(folder.path() / "runs" / record.file_name()), field_file(fields));
  const auto all = figures(Compared(read_study({folder.path()})));
  ASSERT_EQ(all.size(), 1U);
  ASSERT_EQ(all[0].pictures.size(), 3U);
  EXPECT_EQ(all[0].pictures[0].values, (std::vector<Real>{1, 3, 2, 4}));  // rows of the picture
  EXPECT_EQ(all[0].pictures[1].title, "sip");
  EXPECT_EQ(all[0].pictures[1].values, (std::vector<Real>{5, 7, 6, 8}))
      << "x at the last iteration";
  EXPECT_EQ(all[0].pictures[2].values, (std::vector<Real>{9, 11, 10, 12}));
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
  EXPECT_TRUE(has(all[0].reading, "sip has both the least error"));
  EXPECT_TRUE(has(all[1].reading, "rank methods differently"));
  EXPECT_NE(markdown_report(document_of(comparison)).find(all[1].reading.substr(0, 40)),
            std::string::npos);
}

}  // namespace
}  // namespace isoline::reports
