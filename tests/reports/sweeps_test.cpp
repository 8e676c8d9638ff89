// Heat maps of two options, and spectra, from records made by hand.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/files.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

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
  EXPECT_EQ(map.rows[1][1].shade, 1) << "within a factor of two";
  EXPECT_EQ(map.reading,
            "The least median, 1.5, is at kappa = 0.5 and rate = 1; 6 of 6 settings lie within "
            "a factor of two of it.");
  EXPECT_TRUE(has(map.caption, "median over 3 seeds, 100 iterations each"));
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
  EXPECT_EQ(section.plots[0].reading,
            "At the start 2 of 3 lie above 1e-6 of the largest; where gd ended, 3.");
  EXPECT_EQ(section.plots[0].series.size(), 2U);
  EXPECT_EQ(section.plots[0].series[1].y, (std::vector<Real>{20, 4, 2}));
  EXPECT_EQ(section.plots[1].reading, "From 1e8 at the start to 10 where gd ended.");
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

}  // namespace
}  // namespace isoline::reports
