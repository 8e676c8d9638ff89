// Two results as one study, and the page that compares a method with itself.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/compare/gate.h"
#include "reports/page/kinds.h"
#include "reports/read/both_sides.h"
#include "reports/report.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

const std::vector<Result> kBefore = {
    {"a", "gd", 4}, {"b", "gd", 4}, {"a", "adam", 2}, {"b", "adam", 8}};
const std::vector<Result> kAfter = {
    {"a", "gd", 2}, {"b", "gd", 4}, {"a", "adam", 6}, {"b", "sip", 1}};

TEST(BothSides, HoldEachMethodTwiceUnderNamesOfTheirSides) {
  const Study both = study_of_both(study_of(kBefore), study_of(kAfter));
  const Comparison c = compare_sides(both);
  std::vector<std::string> labels;
  for (const OptimizerAxis& axis : c.optimizers) labels.push_back(axis.label);
  std::ranges::sort(labels);
  EXPECT_EQ(labels, (std::vector<std::string>{"adam, BASE", "adam, NEW", "gd, BASE", "gd, NEW",
                                              "sip, NEW"}));
  EXPECT_EQ(c.runs.size(), 8U);
  for (const OptimizerAxis& axis : c.optimizers) {
    EXPECT_EQ(axis.label, axis.method + ", " + axis.side);
    EXPECT_EQ(axis.method.find(','), std::string::npos);
  }
}

TEST(BothSides, PairWhatIsInBoth) {
  const Study both = study_of_both(study_of(kBefore), study_of(kAfter));
  const Comparison c = compare_sides(both);
  const std::vector<InBoth> pairs = methods_in_both(c);
  ASSERT_EQ(pairs.size(), 2U) << "sip is in NEW alone";
  for (const InBoth& pair : pairs) {
    EXPECT_EQ(c.optimizers[pair.before].label, pair.label + ", BASE");
    EXPECT_EQ(c.optimizers[pair.after].label, pair.label + ", NEW");
  }
}

TEST(BothSides, DrawAMethodInOneColourBrokenBefore) {
  const Study both = study_of_both(study_of(kBefore), study_of(kAfter));
  const Comparison c = compare_sides(both);
  for (const InBoth& pair : methods_in_both(c)) {
    const LineStyle before = style_of(c.optimizers[pair.before]);
    const LineStyle after = style_of(c.optimizers[pair.after]);
    EXPECT_EQ(before.kind, after.kind);
    EXPECT_EQ(before.marker, after.marker);
    EXPECT_NE(kDashes[before.dash], "");
    EXPECT_EQ(kDashes[after.dash], "");
  }
}

TEST(ComparisonPage, IsOneFileWithBothSidesAndWhatChanged) {
  const Study both = study_of_both(study_of(kBefore), study_of(kAfter));
  const Section changes{.id = "comparison",
                        .title = "worse: adam on a",
                        .readings = {{"Cause", "a changed default <of> adam."}}};
  const std::string page = comparison_page(compare_sides(both), changes, "BASE: old · NEW: new");
  for (const char* words :
       {"Content-Security-Policy", "BASE: old · NEW: new", "worse: adam on a",
        "a changed default &lt;of&gt; adam.", "id=\"compare\"", "id=\"problems\""})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  EXPECT_EQ(page.find("{{"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = page.find(open) + open.size();
  const Json data = parse_json(page.substr(begin, page.find("</script>", begin) - begin), "data");
  ASSERT_EQ(data.at("sides").size(), 2U);
  EXPECT_EQ(data.at("sides")[0][2], "adam");
  EXPECT_EQ(data.at("optimizers")[data.at("sides")[0][0].get<std::size_t>()], "adam, BASE");
}

TEST(GateSection, HasTheVerdictForItsTitle) {
  const Section section = gate_section(GateResult{.verdict = "nothing is worse"});
  EXPECT_EQ(section.title, "nothing is worse");
}

TEST(ReportPage, OfOneResultKnowsNoSides) {
  const Study study = study_of(kBefore);
  const Document document = document_of(compare_optimizers(study));
  EXPECT_EQ(html_report(document).find("\"sides\""), std::string::npos);
}

}  // namespace
}  // namespace isoline::reports
