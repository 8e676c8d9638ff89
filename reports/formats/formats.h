// The formats of a report that are plain text, one file each: functions of a document.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "reports/sections/sections.h"

namespace isoline::reports {

std::string markdown_report(const Document& document);  // short enough for the summary of a CI job
std::string latex_report(const Document& document);     // tables ready to paste
std::string csv_report(const Document& document);       // one row a run
std::string statistics_csv(const Document& document);   // table,row,column,value
std::string json_report(const Document& document);      // schema isoline.report/1

std::string terminal_table(const Document& document);  // standings, or every cell of a small study
// Within a hundred columns: what it says, then its tables, so many rows of all of them.
inline constexpr std::size_t kAllRows = static_cast<std::size_t>(-1), kFewRows = 20;
std::string terminal_section(const Section& section, std::size_t most_rows = kAllRows);
std::string terminal_claim(const Section& claim);  // one whole: readings, plots, tables
std::string text_plot(const Plot& plot);           // lines in letters, for a terminal
std::string markdown_claim(const Section& claim);
inline constexpr std::size_t kSummaryRows = 60;  // of a table, so that a summary stays a summary
std::string markdown_section(const Section& section, std::size_t most_rows = kSummaryRows);

// Parts of report.json.
nlohmann::json statistics_json(const Document& document);
nlohmann::json claims_json(const std::vector<Judgement>& judgements);

inline constexpr const char* kReportSchema = "isoline.report/1";

// Columns [first, last) beside the names that stand together where `most` have room.
struct Part {
  std::size_t first = 0, last = 0;
};
std::vector<Part> table_parts(const Table& table, std::size_t most);

}  // namespace isoline::reports
