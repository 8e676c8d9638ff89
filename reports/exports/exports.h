// Results in the forms of others: pure functions from a comparison to text, one file a form.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/results/ranking.h"

namespace isoline::reports {

using namespace results;

struct ExportedFile {
  std::string name;  // below the folder that they all go to
  std::string text;
};

// Tidy CSV by RFC 4180, lines ended by CRLF: a row a kept point of each run, with what was asked
// and how it ended in every row; a run that kept none has one row without figures. Numbers read
// back as the same numbers; "inf", "-inf" and "nan" stand for themselves.
std::string curves_csv(const Comparison& comparison);

// Data folders of COCO, which its post-processing reads: for each method FOLDER/isoline_fN.info and
// FOLDER/data_fN/isoline_fN_DIMn.dat and .tdat. Problems are its functions, numbered as
// functions.csv says; seed s is its instance s + 1; an evaluation is one forward solve of declared
// work, counted from 1, the start. Its values are f − f_L.
struct CocoExport {
  std::vector<ExportedFile> files;
  std::vector<std::string> left_out;  // a sentence each
};
CocoExport coco_export(const Comparison& comparison);

// Bencher Metric Format: benchmark "PROBLEM × METHOD" to measures, each the median over seeds with
// the least and the greatest. It has no infinity: what the median run never reached is left out,
// and the share of runs that reached it says so.
std::string bencher_json(const Comparison& comparison);

inline constexpr std::array<std::string_view, 3> kExportNames = {"csv", "coco", "bencher"};

}  // namespace isoline::reports
