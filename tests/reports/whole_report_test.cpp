// Whole reports: each number of the statistics, read back from Markdown, LaTeX, HTML, CSV and JSON,
// is the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "tests/reports/fixture.h"
#include "tests/reports/synthetic.h"
#include "tests/temporary_folder.h"

namespace isoline::reports {
namespace {

using Strings = std::vector<std::string>;
using Rows = std::vector<Strings>;  // the numbers of each row as printed, the name of the row apart

Strings numbers_in(const std::string& text) {
  static const std::regex number(R"re(\d+(\.\d+)?(e-?\d+)?)re");
  Strings found;
  for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it)
    found.push_back(it->str());
  return found;
}

void append(Strings& all, const Strings& some) { all.insert(all.end(), some.begin(), some.end()); }

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return "";
  return text.substr(at, text.find(end, at + begin.size()) - at);
}

Strings split(const std::string& text, const std::string& mark) {
  Strings parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(mark, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + mark.size();
  }
  return parts;
}

Rows of_json(const Json& table) {
  Rows rows;
  for (const Json& row : table.at("rows")) {
    rows.emplace_back();
    for (std::size_t i = 1; i < row.size(); ++i) append(rows.back(), numbers_in(row[i]));
  }
  return rows;
}

// Escaped bars stand in names alone, before the first that separates.
Rows of_markdown(const std::string& report, const std::string& title) {
  Rows rows;
  std::istringstream lines(between(report, "\n### " + title + "\n", "\n##"));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| ")) continue;
    rows.push_back(numbers_in(
        std::regex_replace(line.substr(line.find(" | ")), std::regex("&#?\\w+;|\\\\"), " ")));
  }
  if (!rows.empty()) rows.erase(rows.begin());  // the headings
  return rows;
}

Rows of_html(const std::string& page, const std::string& id) {
  Rows rows;
  const std::string table = std::regex_replace(between(page, "<h3 id=\"" + id + "\">", "</table>"),
                                               std::regex("<(tr|th|td) [^>]*>"), "<$1>");
  for (const std::string& row : split(between(table, "<tbody>", "</nothing>"), "<tr>")) {
    const std::size_t first = row.find("<td>");
    if (row.find("<th>") == std::string::npos) continue;
    rows.push_back(first == std::string::npos ? Strings() : numbers_in(row.substr(first)));
  }
  return rows;
}

// A wide table comes in several, seven columns each.
Rows of_latex(const std::string& report, const std::string& title) {
  Rows rows;
  for (const std::string& rest : split(report, "\\begin{table}")) {
    const std::string part = rest.substr(0, rest.find("\\end{table}"));  // figures follow
    if (part.find("caption{" + title + ". ") == std::string::npos) continue;
    std::size_t i = 0;
    for (const std::string& line : split(between(part, "\\midrule\n", "    \\bottomrule"), "\n")) {
      const std::size_t first = line.find(" & ");
      if (first == std::string::npos) continue;
      if (rows.size() <= i) rows.emplace_back();
      append(rows[i++], numbers_in(line.substr(first)));
    }
  }
  return rows;
}

// table,row,column,value: rows follow one another.
Strings of_csv(const std::string& csv, const std::string& id) {
  Strings all;
  for (const std::string& line : split(csv, "\n"))
    if (line.starts_with(id + ",")) append(all, numbers_in(line.substr(line.rfind(','))));
  return all;
}

Strings joined(const Rows& rows) {
  Strings all;
  for (const Strings& row : rows) append(all, row);
  return all;
}

// Half a unit of the last digit printed.
Real rounding_of(const std::string& printed) {
  const std::size_t e = printed.find('e'), point = printed.find('.');
  const std::size_t end = std::min(e, printed.size());
  const Real places = point == std::string::npos ? 0 : Real(end - point - 1);
  const Real power = e == std::string::npos ? 0 : std::stod(printed.substr(e + 1));
  return 0.5 * std::pow(10.0, power - places) * (1 + 1e-6);
}

class SameFigures : public testing::Test {
 protected:
  SameFigures() {
    write_synthetic_study(
        folder_.path(),
        {.problems = 9, .optimizers = 9, .seeds = 3, .points = 30, .is_sample = true});
    study_ = read_study({folder_.path()});
    document_ = document_of(compare_optimizers(study_));
    json_ = parse_json(json_report(document_), "report.json");
  }

  const Json& tables() const {
    for (const Json& section : json_.at("sections"))
      if (section.at("id") == "statistics") return section.at("tables");
    return json_.at("statistics");  // throws
  }

  ResultFolder folder_;
  Study study_;
  Document document_;
  Json json_;
};

TEST_F(SameFigures, AreInEveryFormat) {
  const std::string html = readable_html(document_), markdown = markdown_report(document_),
                    latex = latex_report(document_), csv = statistics_csv(document_);
  std::size_t count = 0;
  for (const Json& table : tables()) {
    const std::string id = table.at("id"), title = table.at("title");
    const Rows rows = of_json(table);
    count += joined(rows).size();
    if (rows.empty()) continue;
    EXPECT_EQ(of_html(html, id), rows) << id;
    EXPECT_EQ(joined(of_markdown(markdown, title)), joined(rows)) << id;
    EXPECT_EQ(joined(of_latex(latex, title)).size(), joined(rows).size()) << id;
    Strings sorted = joined(of_latex(latex, title)), expected = joined(rows);
    std::ranges::sort(sorted);  // the parts of a wide table come one after the other
    std::ranges::sort(expected);
    EXPECT_EQ(sorted, expected) << id;
    EXPECT_EQ(of_csv(csv, id), joined(rows)) << id;
  }
  EXPECT_GT(count, 500U) << "the numbers were not found";
}

TEST_F(SameFigures, HaveColumnsOfNumbersInCsv) {
  std::map<std::string, std::size_t> filled;
  for (const std::string& line : split(statistics_csv(document_), "\n")) {
    std::vector<std::string> fields = split(line, ",");
    if (line.find('"') != line.npos || fields.size() < 9 || fields[0] == "table") continue;
    for (std::size_t i = 3; i < 7; ++i) {
      if (fields[i].empty()) continue;
      EXPECT_TRUE(fields[i] == "inf" || std::isfinite(std::stod(fields[i]))) << line;
      ++filled[std::to_string(i)];
    }
    if (fields[7] == "%") {
      EXPECT_TRUE(fields[8].ends_with(" %")) << line;
    }
  }
  EXPECT_GT(filled["3"], 100U) << "values";
  EXPECT_GT(filled["4"], 10U) << "lower ends";
  EXPECT_EQ(filled["4"], filled["5"]);
  EXPECT_GT(filled["6"], 10U) << "counts";
}

// The first number of a cell is the first that its text prints, to the digits printed.
TEST_F(SameFigures, AreTheNumbersThatTheirTextsRound) {
  std::size_t count = 0;
  for (const Json& table : tables())
    for (std::size_t i = 0; i < table.at("rows").size(); ++i)
      for (std::size_t k = 1; k < table["rows"][i].size(); ++k) {
        const std::string text = table["rows"][i][k];
        const Json& named = table.at("values")[i][k];
        const Strings printed = numbers_in(text);
        for (const char* name : {"share", "median", "expected", "adjusted_p", "area", "mean", "sum",
                                 "declared", "count", "digits", "failed"}) {
          if (!named.contains(name) || printed.empty()) continue;
          if (std::string(name) == "count" && named.contains("share")) continue;
          const Real value = (std::string(name) == "share" ? 100 : 1) * real_of(named[name]);
          if (!std::isfinite(value)) {
            EXPECT_TRUE(has(text, "✗")) << table["id"] << ": " << text;
            continue;
          }
          EXPECT_NEAR(std::abs(value), std::stod(printed[0]), rounding_of(printed[0]))
              << table["id"] << " " << name << ": " << text;
          ++count;
        }
      }
  EXPECT_GT(count, 200U) << "the numbers were not found";
}

TEST_F(SameFigures, AreOfWholeRowsWithFailedRunsAndAReading) {
  for (const Table& table : document_.section("statistics").tables) {
    EXPECT_FALSE(table.reading.empty()) << table.id;
    EXPECT_TRUE(std::ranges::find(table.columns, "failed") != table.columns.end() ||
                table.id == "prices" || table.id == "choices")
        << table.id;
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size()) << table.id;
  }
}

// Reports of thousands of synthetic records contain each of them.

#ifdef ISOLINE_SANITIZE  // some ten times slower
constexpr SyntheticSize kSize{.problems = 10, .optimizers = 10, .seeds = 2, .random_seed = 7};
#else
constexpr SyntheticSize kSize{.problems = 20, .optimizers = 20, .seeds = 5, .random_seed = 7};
#endif

struct Tally {
  std::size_t runs = 0, failed = 0, planned = 0;
};

// Of the records themselves, not by way of a report.
std::map<Status, std::size_t> statuses_drawn() {
  std::map<Status, std::size_t> statuses;
  for (std::size_t i = 0; i < kSize.records(); ++i) ++statuses[synthetic_record(kSize, i).status];
  return statuses;
}

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

TEST(SyntheticRecords, AreTheSameFromTheSameSeedAndOthersFromAnother) {
  SyntheticSize other = kSize;
  ++other.random_seed;
  for (const std::size_t i : {std::size_t{0}, kSize.records() / 3, kSize.records() - 1}) {
    const Json record = to_json(synthetic_record(kSize, i));
    EXPECT_EQ(record, to_json(synthetic_record(kSize, i))) << i;
    EXPECT_NE(record, to_json(synthetic_record(other, i))) << i;
  }
}

TEST(SyntheticRecords, KeepTheSchemaOfRecordsAndHaveTwelveColumns) {
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/run.json");
  for (std::size_t i = 0; i < kSize.records(); i += 17) {
    const Record record = synthetic_record(kSize, i);
    EXPECT_EQ(schema_violations(to_json(record), schema), std::vector<std::string>{}) << i;
    if (record.status == Status::inapplicable) continue;
    const Json curve = to_json(record).at("curve");
    EXPECT_EQ(curve.size() - 1 + curve.at("counts").size(), 12U);  // `counts` holds columns itself
    EXPECT_EQ(curve.at("loss").size(), kSize.points);
  }
}

TEST(Report, OfThousandsOfRecordsCountsEachOnceAndStatesTheSameNumberOfFailuresEverywhere) {
  const TemporaryFolder owned;
  const std::filesystem::path& folder = owned.path();
  write_synthetic_study(folder, kSize);
  const Study study = read_study({folder});
  ASSERT_EQ(study.runs.size(), kSize.records());
  EXPECT_TRUE(study.unreadable.empty());
  const Document document = document_of(compare_optimizers(study));
  const Comparison& comparison = document.comparison;
  EXPECT_EQ(comparison.answered, kSize.records());
  EXPECT_EQ(comparison.statuses, statuses_drawn());
  EXPECT_EQ(comparison.problems.size(), kSize.problems);
  EXPECT_EQ(comparison.optimizers.size(), kSize.optimizers);
  Tally all;
  for (const auto& row : comparison.cells)
    for (const Cell& cell : row) {
      all.runs += cell.runs.size();
      all.failed += cell.failed;
      all.planned += cell.planned;
      EXPECT_EQ(cell.runs.size(), kSize.seeds);
      if (!cell.is_measured()) continue;
      for (const Spread& work : cell.headline) EXPECT_EQ(work.n, kSize.seeds);
      EXPECT_EQ(cell.loss.n, kSize.seeds);
    }
  EXPECT_EQ(all.runs, kSize.records());
  EXPECT_EQ(all.planned, kSize.records());
  EXPECT_EQ(all.failed, comparison.failures.size());
  EXPECT_GT(all.failed, 0U);
  write_report(document, folder / "report");
  EXPECT_EQ(line_count(read_text(folder / "report/report.csv")), kSize.records() + 1);  // a header
  const Json report = read_json(folder / "report/report.json");
  EXPECT_EQ(report.at("failures").size(), comparison.failures.size());
  std::size_t runs = 0, failed = 0;
  for (const Json& optimizer : report.at("optimizers")) {
    runs += optimizer.at("runs").get<std::size_t>();
    failed += optimizer.at("failed").get<std::size_t>();
  }
  EXPECT_EQ(failed, comparison.failures.size());
  EXPECT_EQ(runs, kSize.records() - statuses_drawn()[Status::inapplicable]);
}

TEST(Report, OfTrimmedRecordsIsThatOfWholeOnes) {
  const TemporaryFolder owned;
  write_synthetic_study(owned.path(), {.problems = 4, .optimizers = 5, .seeds = 3});
  const std::vector<std::string> twice(2, owned.path().string());  // each record has another
  const Study whole = read_study(twice);
  const Study trimmed =
      read_study(twice, {}, [](Record& record) { trim_for_report(record, false); });
  EXPECT_TRUE(std::ranges::all_of(
      trimmed.runs, [](const Record& run) { return run.curve.gradient_norm.empty(); }));
  EXPECT_EQ(trimmed.superseded, whole.runs.size());
  const Document one = document_of(compare_optimizers(whole)),
                 other = document_of(compare_optimizers(trimmed));
  for (const Format& format : kFormats)
    EXPECT_TRUE(format.text(one) == format.text(other)) << format.file;
}

TEST(Report, OfTenThousandCellsIsWholeAndItsPageBelowEightMegabytes) {
  constexpr std::uintmax_t kMostBytes = 8'000'000;
#ifdef ISOLINE_SANITIZE
  constexpr std::size_t kOptimizers = 40;
#else
  constexpr std::size_t kOptimizers = 400;
#endif
  const TemporaryFolder owned;
  const std::filesystem::path& folder = owned.path();
  write_synthetic_study(folder,
                        {.problems = 25, .optimizers = kOptimizers, .seeds = 1, .is_sample = true});
  const Study study = read_study({folder});
  EXPECT_EQ(study.plan.cells.size(), 25 * kOptimizers);
  EXPECT_LT(study.runs.size(), study.plan.cells.size());  // a few are missing on purpose
  EXPECT_TRUE(study.unreadable.empty());
  write_report(document_of(compare_optimizers(study)), folder / "report");
  EXPECT_LT(std::filesystem::file_size(folder / "report" / "index.html"), kMostBytes);
  const std::string csv = read_text(folder / "report" / "report.csv");
  EXPECT_EQ(line_count(csv),
            study.plan.cells.size() + 1);  // a header; missing cells have a row too
}

}  // namespace
}  // namespace isoline::reports
