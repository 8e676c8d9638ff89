// The report of a study: one page for people, and the same figures as Markdown, LaTeX, CSV, JSON.
//
//   study                           reads the folders
//   axes, reached, comparison       puts runs into cells and aggregates them: every figure
//   statistics/                     medians, profiles, ranks, tests, running times, costs, who
//   leads tables/                         the tables of statistics, in every format plots/ their
//   plots: numbers and SVG figures/                        the figures of the papers, panel by
//   panel audit/                          the measured properties, in each format claims/ what
//   papers say, held against the runs compare/                        what got worse from one
//   result to another; baselines learned                         what networks have learned text,
//   wording, readings         how figures, phrases and whole sentences are written csv, json,
//   latex, markdown,     one output format each terminal, html/ and page/
#pragma once

#include <filesystem>
#include <string>

#include "reports/comparison.h"
#include "reports/study.h"

namespace isoline::reports {

// Writes index.html, report.md, report.tex, report.csv, statistics.csv and report.json; makes the
// folder.
void write_report(const Comparison& comparison, const std::filesystem::path& out);

std::string html_report(const Comparison& comparison);
std::string markdown_report(const Comparison& comparison);
std::string latex_report(const Comparison& comparison);
std::string csv_report(const Comparison& comparison);   // one row a run
std::string json_report(const Comparison& comparison);  // schema isoline.report/1
std::string terminal_table(const Comparison& comparison);

inline constexpr const char* kReportSchema = "isoline.report/1";

}  // namespace isoline::reports
