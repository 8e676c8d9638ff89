// The formats of a report that are plain text, one file each: functions of a document. Foreign text
// is made safe for the place it goes to.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "reports/sections/sections.h"

namespace isoline::reports {

std::string markdown_report(const Document& document);  // short enough for the summary of a CI job
std::string csv_report(const Document& document);       // one row a run
std::string statistics_csv(const Document& document);   // table,row,column,value
std::string json_report(const Document& document);      // schema isoline.report/1
// Which records a comparison is of, with the f_L and the scale of each: its problems and cells in
// the form of json_report.
std::string json_of_runs(const Comparison& comparison);

// These two draw plots: reports/page.
std::string html_report(const Document& document);   // the page
std::string latex_report(const Document& document);  // a document, and for \\input in a paper

struct Format {
  const char* file;
  std::string (*text)(const Document&);
};
inline constexpr Format kFormats[] = {  // all that `isoline report` writes
    {"index.html", html_report},  {"report.csv", csv_report},
    {"report.json", json_report}, {"report.md", markdown_report},
    {"report.tex", latex_report}, {"statistics.csv", statistics_csv}};

// The width of a text: in a pipe, prose has 80 columns and tables are whole.
struct Columns {
  std::size_t prose = 80, table = static_cast<std::size_t>(-1);
};
std::string terminal_table(const Document& document);  // standings, or every cell of a small study
std::string terminal_table(const Document& document, const Columns& columns);
// The sentences of a section, then its tables, so many rows of all of them.
inline constexpr std::size_t kAllRows = static_cast<std::size_t>(-1), kFewRows = 20;
std::string terminal_section(const Section& section, std::size_t most_rows = kAllRows,
                             const Columns& columns = {});
// One whole: readings, tables.
std::string terminal_claim(const Section& claim, const Columns& columns = {});
inline constexpr std::size_t kSummaryRows = 60;  // of a table, so that a summary stays a summary
std::string markdown_section(const Section& section, std::size_t most_rows = kSummaryRows);

nlohmann::json section_json(const Section& section);                   // its sentences and tables
nlohmann::json claims_json(const std::vector<Judgement>& judgements);  // as in report.json

// Columns that stand together: those that name the rows, then as many others as have room, or as
// the table asks for.
using Part = std::vector<std::size_t>;
std::vector<Part> table_parts(const Table& table, std::size_t most);

std::string html_text(std::string_view text);
std::string markdown_text(std::string_view text);
std::string latex_text(std::string_view text);
std::string latex_words(std::string_view text);      // Greek letters and marks as commands
std::string csv_field(std::string_view text);        // no spreadsheet runs it
std::string exact_csv_field(std::string_view text);  // to the byte, for programs
std::string terminal_text(std::string_view text);    // no escape sequence passes

}  // namespace isoline::reports
