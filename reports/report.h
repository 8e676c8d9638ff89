// The report of a study: one page for people, and the same figures as Markdown, LaTeX, CSV, JSON.
//
//   study                           reads the folders
//   axes, reached, comparison       puts runs into cells and aggregates them: every figure
//   statistics, standings           medians, profiles, who leads and how sure that is
//   rank_tests, runtimes            tests by ranks; running times, areas, resamples
//   costs, orders                   equivalent forward solves; ranks, ratios and digits by problem
//   tables (tables_*)               the tables of statistics, in every format
//   plots (plots_*, plot_*), frame  the plots of statistics, their numbers and their SVG
//   curves, contour, targets        what the plots draw, what the page computes anew
//   lead                            by how much the first is ahead: the first screen
//   mathml (mathml_*)               formulas of the sheets, typeset
//   claims, quantities              what papers say, held against the runs
//   text, wording, readings         how figures, phrases and whole sentences are written
//   audit (audit_*)                 the table of measured properties, in each format
//   csv, json, latex, markdown,     one output format each
//   terminal, html (html_*, page/)
#pragma once

#include <filesystem>
#include <string>

#include "reports/comparison.h"
#include "reports/study.h"

namespace isoline {

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

}  // namespace isoline
