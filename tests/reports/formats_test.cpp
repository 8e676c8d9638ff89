// Formats and their sentences: foreign text is harmless in each, and all print the same number.
#include "reports/formats/formats.h"

#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"
#include "tests/reports/synthetic.h"

namespace isoline::reports {

std::string_view embedded_page_js();

namespace {

constexpr const char* kHostile = "<b>&|\"x\"</script><!--@all `$\\evil_{1}%#~^\n=cmd,*[";

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
  EXPECT_EQ(terminal_text("Traceback:\n\tline 1\x1b"), "Traceback:  line 1?");
  EXPECT_EQ(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
  EXPECT_EQ(csv_field("=1+1"), "\"'=1+1\"");
}

TEST(Html, HostileNamesStayText) {
  const Study study = hostile_study();
  std::string page = readable_html(document_of(compare_optimizers(study)));
  const std::string of_memory = "src=\"${URL.createObjectURL(";  // no request
  ASSERT_TRUE(has(page, of_memory));
  page.erase(page.find(of_memory), of_memory.size());
  EXPECT_FALSE(has(page, "<b>&|"));
  EXPECT_FALSE(has(page, "</script><!--@all"));
  EXPECT_TRUE(has(page, "&lt;b&gt;&amp;|&quot;x&quot;"));
  for (const char* asking : {"src=", "@import", "url(", "fetch(", "XMLHttpRequest", "href=\"http"})
    EXPECT_FALSE(has(page + std::string(embedded_page_js()), asking))
        << "it asks nothing of the network: " << asking;
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

TEST(Latex, HasGreekLetters) {
  const std::string tex =
      latex_report(document_of(Compared(study_of({{"p", "Δη", 1}, {"p", "b", 2}}))));
  EXPECT_TRUE(has(tex, "$\\Delta$$\\eta$")) << tex;
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
  EXPECT_LE(lines.size(), 120U);
  const auto columns_of = [](const std::string& line) {
    return std::ranges::count_if(line, [](char c) { return (c & 0xC0) != 0x80; });
  };
  for (const std::string& line : lines) EXPECT_LE(columns_of(line), 100) << line;
  for (const std::size_t columns : {60U, 75U})
    for (const std::string& line : lines_of(terminal_table(document_of(compare_optimizers(study)),
                                                           {.prose = columns, .table = columns})))
      EXPECT_LE(columns_of(line), std::ptrdiff_t(columns)) << line;
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
       {readable_html(document), markdown_report(document), latex_report(document),
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
       {readable_html(document), markdown_report(document), terminal_table(document)})
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
  const std::string page = readable_html(document), markdown = markdown_report(document),
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
  request.budget.stall = 0;
  EXPECT_TRUE(has(rerun_command(request), " --stall never"));
  request.budget.discrepancy = 1.5;
  EXPECT_TRUE(has(rerun_command(request), " --stop 'discrepancy[tau=1.5]'"));
  request.problem.foreign = Foreign{.door = "plugin", .command = "my lib.so"};
  EXPECT_TRUE(has(rerun_command(request), " --plugin 'my lib.so'"));
}

// The new report.tex cannot be written.
TEST(Report, ReplacesAnEarlierOneWholeOrNotAtAll) {
  const TemporaryFolder owned;
  const std::filesystem::path out = owned.path() / "report";
  write_report(document_of(Compared(study_of({{"p", "a", 1}}))), out);
  const std::string page = read_text(out / "index.html"), csv = read_text(out / "report.csv");
  std::filesystem::path blocked = out / "report.tex";
  for (int i = 0; i < 2; ++i) {
    blocked = temporary_of(blocked);
    std::filesystem::create_directories(blocked / "full");
  }
  EXPECT_ANY_THROW(write_report(document_of(Compared(study_of({{"p", "b", 1}}))), out));
  EXPECT_EQ(read_text(out / "index.html"), page);
  EXPECT_EQ(read_text(out / "report.csv"), csv);
  for (const std::string& name : names_in(out))
    EXPECT_FALSE(name.ends_with(".tmp") && is_abandoned(out / name)) << name;
}

// The files of a report in a folder, by name.
std::map<std::string, std::string> report_in(const std::filesystem::path& out) {
  std::map<std::string, std::string> files;
  for (const Format& format : kFormats)
    if (is_there(out / format.file)) files[format.file] = read_text(out / format.file);
  return files;
}

// Another process replaces one report by another, and stops at each of its calls of the system, so
// that the folder is read as a kill at this moment would leave it.
TEST(Report, ThatReplacesAnotherIsNeverMixedWithItWhereverItIsKilled) {
  const TemporaryFolder owned;
  const std::filesystem::path out = owned.path() / "report", other = owned.path() / "other";
  const auto written = [](const char* method, const std::filesystem::path& folder) {
    write_report(document_of(Compared(study_of({{"p", method, 1}}))), folder);
    return report_in(folder);
  };
  const auto before = written("a", out), after = written("b", other);
  ASSERT_EQ(before.size(), std::size(kFormats));
  for (const auto& [name, text] : before) ASSERT_NE(text, after.at(name)) << name;
  const pid_t child = fork();
  if (child == 0) {
    ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    raise(SIGSTOP);
    written("b", out);
    _exit(0);
  }
  const auto inodes = [&] {
    std::vector<ino_t> all;
    for (const Format& format : kFormats) {
      struct stat file {};
      all.push_back(stat((out / format.file).c_str(), &file) == 0 ? file.st_ino : 0);
    }
    return all;
  };
  int status = 0, states = 0;
  auto seen = inodes();
  while (waitpid(child, &status, 0) == child && WIFSTOPPED(status)) {
    if (const auto now = inodes(); now != seen) {
      ++states;
      seen = now;
      const auto files = report_in(out);
      const bool is_new = !files.empty() && files.begin()->second == after.at(files.begin()->first);
      for (const auto& [name, text] : files)
        EXPECT_TRUE(text == (is_new ? after : before).at(name)) << name << " " << states;
      EXPECT_TRUE(!files.contains("index.html") || files.size() == after.size()) << states;
    }
    ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
  }
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_TRUE(report_in(out) == after);
  EXPECT_EQ(states, 2 * static_cast<int>(std::size(kFormats))) << "each file goes and comes";
}

// The sentences of reports/words/: each is well formed, and sources use all of them and no others.

TEST(Words, FillTheNamesThatTheirKeysDeclare) {
  for (const auto& [key, sentence] : all_sentences()) {
    const bool has_format = sentence.text.find(':', sentence.text.find('{')) != std::string::npos;
    const Value one = has_format ? Value(Real{1}) : Value(std::int64_t{1});
    EXPECT_NO_THROW(filled(key, std::vector<Value>(sentence.names.size(), one))) << key;
    EXPECT_EQ(sentence.text.find("  "), std::string::npos) << key;
  }
}

TEST(Words, FollowCountsAndFormats) {
  EXPECT_TRUE(words("remarks.unreadable", 1).starts_with("Unreadable: 1 file,"));
  EXPECT_TRUE(words("remarks.unreadable", 2).starts_with("Unreadable: 2 files,"));
  EXPECT_NE(words("limits.detectable", 0.0123).find(" 0.012 "), std::string::npos);
  EXPECT_EQ(worded_table("calls", "1e-6", "").columns,
            (std::vector<std::string>{"optimizer", "runs to 1e-6"}));
}

TEST(Words, WithoutSuchAKeyOrForOtherValuesAreErrors) {
  EXPECT_THROW(words("no.such.key"), std::logic_error);
  EXPECT_THROW(words("limits.detectable"), std::logic_error);
  EXPECT_THROW(words("limits.detectable", 1, 2), std::logic_error);
}

// A key is written whole in a source, or its beginning is ("column." + name), or it is a part that
// a table, a plot or a section takes by its name.
TEST(Words, OfTwoDifferentNumbersAreNotOne) {
  EXPECT_EQ(multiple(1), "1×");
  EXPECT_EQ(multiple(1.00428), "1.0043×");
  EXPECT_EQ(multiple(2.006), "2.01×");
}

TEST(Words, AreThoseThatSourcesName) {
  std::string sources;
  for (const char* folder : {"reports/sections", "reports/page"})
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(ISOLINE_SOURCE_DIR) / folder))
      sources += read_text(entry.path());
  const auto has = [&](const std::string& text) { return sources.find(text) != std::string::npos; };
  static const std::regex part(
      R"((.+)\.(title|caption|columns|meanings|align|x|y|lead|otherwise|reading))"),
      beginning(R"(([a-z]+[.-]).+)");
  std::smatch match;
  for (const auto& [key, sentence] : all_sentences()) {
    const bool is_part = std::regex_match(key, match, part) && has('"' + match[1].str() + '"');
    const bool is_named = std::regex_match(key, match, beginning) && has('"' + match[1].str());
    EXPECT_TRUE(has('"' + key + '"') || is_part || is_named) << key << " is not used";
  }
  static const std::regex use(R"(words\(\s*"([a-z0-9.-]+[a-z0-9])\")");
  for (std::sregex_iterator it(sources.begin(), sources.end(), use), end; it != end; ++it)
    EXPECT_TRUE(all_sentences().contains((*it)[1].str())) << (*it)[1] << " is not there";
}

}  // namespace
}  // namespace isoline::reports
