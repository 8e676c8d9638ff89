// The formats: foreign text is harmless in each, and all print the same figure.
#include "reports/formats/formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/json.h"
#include "core/records/json_view.h"
#include "reports/report.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"
#include "tests/reports/synthetic.h"

namespace isoline::reports {
namespace {

constexpr const char* kHostile = "<b>&|\"x\"</script><!--@all `$\\evil_{1}%#~^\n=cmd,*[";

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Study hostile_study() {
  Study study;
  study.runs = {record_of({.problem = kHostile,
                           .optimizer = kHostile,
                           .hits = 2,
                           .status = Status::failed,
                           .message = kHostile})};
  return study;
}

std::size_t fields(const std::string& line) {
  bool is_quoted = false;
  std::size_t count = 1;
  for (const char letter : line) {
    if (letter == '"') is_quoted = !is_quoted;
    if (letter == ',' && !is_quoted) ++count;
  }
  return count;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(Figure, IsShortAndReadable) {
  EXPECT_EQ(figure(12345), "12345");
  EXPECT_EQ(figure(12.5), "12.5");
  EXPECT_EQ(figure(1.23456e-8), "1.235e-8");
  EXPECT_EQ(figure(0.00018), "1.8e-4");
  EXPECT_EQ(figure(0.0002), "2e-4");
  EXPECT_EQ(figure(0.0123456), "0.01235");
  EXPECT_EQ(milliseconds(3.847e-5), "0.0385");
  EXPECT_EQ(milliseconds(61.2), "61200");
  EXPECT_EQ(figure(123456789.0), "1.235e8");
  EXPECT_EQ(figure(1e100), "1e100");
  EXPECT_EQ(figure(-0.0), "0");
  EXPECT_EQ(figure(kNever), "inf");
  EXPECT_EQ(figure(NAN), "nan");
  EXPECT_EQ(std::stod(exact_figure(0.1 + 0.2)), 0.1 + 0.2);
  EXPECT_EQ(figure(spread_of({3, 1, kNever})), "3 (1–✗)");
}

TEST(Spec, LongNumbersAreCutForReaders) {
  EXPECT_EQ(shown_spec("newton[rate=0.3333333333333333]"), "newton[rate=0.3333]");
  EXPECT_EQ(shown_spec("sip[step=0.05,inverse=lbfgs]"), "sip[step=0.05,inverse=lbfgs]");
  EXPECT_EQ(shown_spec("adam[rate=0.001,rule=a-very-long-word]"),
            "adam[rate=0.001,rule=a-very-long-word]");
}

TEST(Escape, EachFormatHasItsOwn) {
  EXPECT_EQ(html_text("<b>&|\"'"), "&lt;b&gt;&amp;|&quot;&#39;");
  EXPECT_EQ(markdown_text("a|b\n@x_*"), "a\\|b &#64;x\\_\\*");
  EXPECT_EQ(latex_text("50 % & x_1 \\ é"), "50 \\% \\& x\\_1 \\textbackslash{} ?");
  EXPECT_EQ(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
  EXPECT_EQ(csv_field("=1+1"), "\"'=1+1\"");
}

TEST(Html, HostileNamesStayText) {
  const Study study = hostile_study();
  const std::string page = html_report(document_of(compare_optimizers(study)));
  EXPECT_FALSE(has(page, "<b>&|"));
  EXPECT_FALSE(has(page, "</script><!--@all"));
  EXPECT_TRUE(has(page, "&lt;b&gt;&amp;|&quot;x&quot;"));
  EXPECT_TRUE(has(page, "\\u003c/script>\\u003c!--@all"));
  for (const char* asking : {"src=", "@import", "url(", "fetch(", "XMLHttpRequest", "href=\"http"})
    EXPECT_FALSE(has(page, asking)) << "it asks nothing of the network: " << asking;
}

TEST(Markdown, HostileNamesBreakNoRow) {
  const Study study = hostile_study();
  std::size_t expected = 0;  // bars of the table's first line
  for (const std::string& line :
       lines_of(markdown_report(document_of(compare_optimizers(study))))) {
    std::size_t bars = 0;
    for (std::size_t i = 0; i < line.size() && line.starts_with("|"); ++i)
      bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
    if (bars == 0 || expected == 0) expected = bars;
    EXPECT_EQ(bars, expected) << line;
  }
}

TEST(Latex, HostileNamesKeepTheTableWhole) {
  const Study study = hostile_study();
  const std::string tex = latex_report(document_of(compare_optimizers(study)));
  int depth = 0;
  for (std::size_t i = 0; i < tex.size(); ++i) {
    if (tex[i] == '\\') {
      ++i;
      continue;
    }
    depth += tex[i] == '{' ? 1 : tex[i] == '}' ? -1 : 0;
    EXPECT_GE(depth, 0);
    EXPECT_LT(static_cast<unsigned char>(tex[i]), 0x80);
  }
  EXPECT_EQ(depth, 0);
  EXPECT_FALSE(has(tex, "$\\evil"));
}

TEST(Csv, EveryRowHasAllFields) {
  Study study = hostile_study();
  study.plan.cells.push_back({"missing-cell", "square", "gd,x", 3});
  const auto lines = lines_of(csv_report(document_of(compare_optimizers(study))));
  ASSERT_EQ(lines.size(), 3U);
  for (const std::string& line : lines) EXPECT_EQ(fields(line), fields(lines[0])) << line;
  EXPECT_TRUE(has(lines[2], "missing-cell"));
}

// 20 problems × 33 optimizers would be a thousand lines; the summary is one for each, and no wider
// than a terminal.
TEST(Terminal, ALargeStudyIsSummedUp) {
  const ResultFolder folder;
  write_synthetic_study(
      folder.path(),
      {.problems = 20, .optimizers = 33, .seeds = 2, .points = 20, .is_sample = true});
  const Study study = read_study({folder.path()});
  const auto lines = lines_of(terminal_table(document_of(compare_optimizers(study))));
  EXPECT_LE(lines.size(), 90U);
  for (const std::string& line : lines)
    EXPECT_LE(std::ranges::count_if(line, [](char c) { return (c & 0xC0) != 0x80; }), 100) << line;
}

TEST(Terminal, NoEscapeSequencePasses) {
  Study study;
  study.runs = {record_of({.optimizer = "gd\x1b[31m",
                           .hits = 1,
                           .status = Status::failed,
                           .message = "\x1b]0;owned\x07"})};
  EXPECT_FALSE(has(terminal_table(document_of(compare_optimizers(study))), "\x1b"));
}

// Work to 1e-6 is index 30 · 4567 = 137010; the median of one run is itself.
TEST(Formats, AllPrintTheSameFigure) {
  Study study;
  study.runs = {record_of({.work_per_hit = 4567})};
  const Document document = document_of(compare_optimizers(study));
  for (const std::string& text :
       {html_report(document), markdown_report(document), latex_report(document),
        csv_report(document), terminal_table(document)})
    EXPECT_TRUE(has(text, "137010"));
  const Json json = parse_json(json_report(document), "report");
  EXPECT_EQ(json["schema"], "isoline.report/1");
  EXPECT_EQ(json["cells"][0]["figures"]["work"]["1e-6"]["median"], 137010);
}

TEST(Formats, APartialStudySaysSoInAll) {
  Study study;
  study.runs = {record_of({})};
  study.plan = plan_of({study.runs[0], record_of({.seed = 1})});
  const Document document = document_of(compare_optimizers(study));
  for (const std::string& text :
       {html_report(document), markdown_report(document), terminal_table(document)})
    EXPECT_TRUE(has(text, "1 of 2 cells, missing"));
  EXPECT_TRUE(has(latex_report(document), "1 of 2 cells"));
  EXPECT_TRUE(has(csv_report(document), ",missing,"));
}

TEST(Json, ConformsToItsSchema) {
  const ResultFolder folder;
  write_synthetic_study(
      folder.path(),
      {.problems = 5, .optimizers = 33, .seeds = 2, .points = 20, .is_sample = true});
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/report.json");
  for (const Study& study : {read_study({folder.path()}), hostile_study(), Study{}}) {
    const Json report = parse_json(json_report(document_of(compare_optimizers(study))), "report");
    EXPECT_EQ(schema_violations(report, schema), std::vector<std::string>());
  }
}

TEST(Formats, AnEmptyFolderIsReported) {
  const ResultFolder folder;
  const Study study = read_study({folder.path()});
  write_report(document_of(compare_optimizers(study)), folder.path() / "report");
  for (const Format& format : kFormats)
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "report" / format.file)) << format.file;
}

// Whatever a section says, every format that lays sections out says too.
TEST(Formats, EverySectionIsInEachOfThem) {
  Study study = study_of({{"p", "a", 1}, {"p", "b", 2}, {"q", "a", 1}, {"q", "b", 0}});
  study.unreadable = {{"torn.json", "no JSON"}};
  study.audits = {{.name = "a", .spec = "a", .reason = "it has no step"}};
  const Document document = document_of(compare_optimizers(study), {{.sentence = "It is so."}});
  const std::string page = html_report(document), markdown = markdown_report(document),
                    latex = latex_report(document);
  for (const Section& section : document.sections) {
    if (section.is_empty()) continue;
    EXPECT_TRUE(has(markdown, "## " + markdown_text(section.title))) << section.id;
    EXPECT_FALSE(terminal_section(section).empty()) << section.id;
    for (const Table& table : section.tables) {
      EXPECT_TRUE(table.title.empty() || has(markdown, markdown_text(table.title))) << table.id;
      if (table.rows.empty()) continue;
      const std::string name = table.rows[0][0].text;
      EXPECT_TRUE(has(page, html_text(name))) << table.id;
      EXPECT_TRUE(has(markdown, "| " + markdown_text(name))) << table.id;
      EXPECT_TRUE(table.is_wordy() || has(latex, "    " + latex_text(name) + " & ")) << table.id;
    }
  }
}

TEST(Formats, TheSameStudyGivesTheSameBytes) {
  const ResultFolder folder;
  write_synthetic_study(
      folder.path(),
      {.problems = 3, .optimizers = 12, .seeds = 2, .points = 20, .is_sample = true});
  const Study first = read_study({folder.path()}), second = read_study({folder.path()});
  EXPECT_EQ(html_report(document_of(compare_optimizers(first))),
            html_report(document_of(compare_optimizers(second))));
  EXPECT_EQ(json_report(document_of(compare_optimizers(first))),
            json_report(document_of(compare_optimizers(second))));
}

TEST(Rerun, TheCommandAsksForTheCell) {
  Request request = record_of({.problem = "sine[xi=32]", .seed = 7}).request;
  EXPECT_EQ(rerun_command(request),
            "./isoline run --problem 'sine[xi=32]' --optimizer gd --seeds =7 --iterations 1000 "
            "--rates none");
  request.budget.work = 500;
  EXPECT_TRUE(has(rerun_command(request), " --work 500"));
}

}  // namespace
}  // namespace isoline::reports
