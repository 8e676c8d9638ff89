// The audit in reports: the same table in every format, and reports do without it.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

PowerLaw law(Real exponent, Real residual) {
  return {.values = {1, 2, 3}, .exponent = exponent, .residual = residual};
}

AuditedOptimizer sample() {
  AuditedOptimizer audited{.name = "gd", .spec = "gd"};
  for (ScalingLaw& scaling : audited.scalings)
    scaling = {{0.1, 1, 10}, law(1, 1e-15), law(2, 1e-15)};
  audited.scalings[1] = {{0.1, 1, 10}, law(1.3, 0.4), law(1.3, 0.4)};
  audited.scalings[3] = {};
  audited.deviations = {1e-15, 0.25, std::numeric_limits<Real>::infinity(), 0, 0, kUnknown};
  audited.regular = {2.04, 0.01, 1e-16, 4, true};
  audited.singular = {kUnknown, kUnknown, 0.5, 1000, false};
  audited.linear_angle = 2.75;
  audited.counted = {{"forward", 10}, {"pullback", 10}};
  audited.iterations = 10;
  audited.flags = {"declares <b>|x|"};
  return audited;
}

std::vector<AuditedOptimizer> samples() {
  return {sample(), {.name = "kfac", .spec = "kfac", .reason = "there is no network"}};
}

// What stands in the columns of the table, its name left out.
std::vector<std::string> cells_of(const AuditedOptimizer& audited) {
  std::vector<std::string> texts;
  const Section section = properties_section({audited});
  for (const TableCell& cell : section.tables.at(0).rows.at(0)) texts.push_back(cell.text);
  texts.erase(texts.begin());
  return texts;
}

TEST(AuditTable, SaysWhatWasMeasured) {
  const std::vector<std::string> expected = {"1 / 2",           "no power law",
                                             "1 / 2",           "no step",
                                             "kept, 0.25, inf", "kept, kept, no step",
                                             "2.0 in 4",        "no order, 0.5 left of 1000",
                                             "2.8°, no step",   "forward 10, pullback 10 in 10",
                                             "declares <b>|x|"};
  EXPECT_EQ(cells_of(sample()), expected);
}

TEST(AuditTable, IsInEveryFormatAndForeignTextIsHarmless) {
  Study study;
  study.audits = samples();
  const Document document = document_of(compare_optimizers(study));
  const std::string html = section_html(document.section("audit")),
                    markdown = markdown_report(document);
  for (const std::string& text : {html, markdown, terminal_section(document.section("audit"))}) {
    EXPECT_TRUE(has(text, "no power law"));
    EXPECT_TRUE(has(text, "there is no network"));
  }
  const std::string latex = latex_report(document);
  for (const char* part : {"no power law", "kept, 0.25", "2.0 in 4", "2.8", "pullback 10 in 10"})
    EXPECT_TRUE(has(latex, part)) << part;
  EXPECT_FALSE(has(html, "<b>|x|"));
  EXPECT_FALSE(has(markdown, "<b>|x|"));
}

TEST(AuditTable, SaysWhatDoesNotApplyToWhatTeachesANetwork) {
  AuditedOptimizer teacher = sample();
  teacher.network = "mlp";
  teacher.scalings[2] = {};
  teacher.deviations[0] = kUnknown;
  for (const std::size_t column : {2, 3, 4, 6, 7, 8})
    EXPECT_EQ(cells_of(teacher)[column], "does not apply") << column;
  EXPECT_EQ(cells_of(teacher)[0], "1 / 2");
  EXPECT_TRUE(has(property_readings({teacher}).back().text, "gd train a network"));
}

TEST(AuditTable, TellsThePageWhichMethodARowIsAbout) {
  AuditedOptimizer sip = sample();
  sip.name = "sip";
  const std::string html = section_html(properties_section({sample(), sip}));
  for (const char* row : {"<tr data-method=\"gd\">", "<tr data-method=\"sip\">"})
    EXPECT_TRUE(has(html, row)) << row;
}

TEST(AuditTable, IsReadForANewcomer) {
  const std::vector<Reading> readings = property_readings(samples());
  ASSERT_EQ(readings.size(), 6U);
  EXPECT_TRUE(has(readings[0].text, "a small step where a large one is needed: gd"));
  EXPECT_TRUE(has(readings[0].text, "whose Hessian is zero"));
  EXPECT_TRUE(has(readings[2].text, "(order 2): gd"));
  EXPECT_TRUE(has(readings.back().text, "gd declares"));
}

TEST(AuditFile, IsReadWithTheStudyAndReportsDoWithoutIt) {
  const ResultFolder with, without, broken;
  for (const ResultFolder* folder : {&with, &without, &broken}) folder->add(record_of({}));
  with.add_file("audit.json", audit_to_json(samples()).dump());
  broken.add_file("audit.json", "{\"schema\": \"isoline.audit/1\"}");
  const Study study = read_study({without.path(), with.path()}),
              bare = read_study({without.path()}), bad = read_study({broken.path()});
  EXPECT_EQ(study.audits.size(), 2U);
  const Json audit =
      parse_json(json_report(document_of(compare_optimizers(study))), "report").at("audit");
  EXPECT_EQ(audit.at("readings").size(), 6U);
  EXPECT_EQ(audit.at("optimizers"), audit_to_json(samples()).at("optimizers"));
  EXPECT_TRUE(has(markdown_report(document_of(compare_optimizers(study))), "Properties, measured"));
  EXPECT_FALSE(has(markdown_report(document_of(compare_optimizers(bare))), "Properties, measured"));
  EXPECT_TRUE(has(html_report(document_of(compare_optimizers(bare))), "hold no audit"));
  ASSERT_EQ(bad.unreadable.size(), 1U);
  EXPECT_TRUE(bad.unreadable[0].file.ends_with("/audit.json"));
}

}  // namespace
}  // namespace isoline::reports
