// The report of a study: one page for people, and the same figures as Markdown, LaTeX, CSV, JSON.
// Folders from the ground up, above core/results; each may include those above it in this list.
//
// - sections/: the table of runs to sections of sentences, tables and plots, one file a topic, with
//   the sentences of words/; `Document`.
// - formats/: a document to text, one file a format.
// - page/: a document to the page, its charts' data, its style and its scripts.
// - compare/: the gate: what changed from one set of results to another; baselines.
//
// A new statistic is a function in a file of sections/ and its name in a list of
// sections/statistics.cpp; a new format is a file of formats/ and its name in `kFormats` below.
#pragma once

#include <filesystem>
#include <string>

#include "core/results/study.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/sections.h"

namespace isoline::reports {

using namespace results;

// All that are written: a format is, once it is named here.
struct Format {
  const char* file;
  std::string (*text)(const Document&);
};
inline constexpr Format kFormats[] = {
    {"index.html", html_report},  {"report.csv", csv_report},
    {"report.json", json_report}, {"report.md", markdown_report},
    {"report.tex", latex_report}, {"statistics.csv", statistics_csv}};

// Writes every format into the folder, which it makes.
void write_report(const Document& document, const std::filesystem::path& out);

}  // namespace isoline::reports
