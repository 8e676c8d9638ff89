// The HTML page and its parts. An element with data-s or data-p, the index of an optimizer or
// problem, is hidden where the reader filters that one out; with both, where either is.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/results/ranking.h"
#include "reports/page/svg.h"
#include "reports/sections/figures.h"
#include "reports/sections/sections.h"

namespace isoline::reports {

using namespace results;

std::string html_report(const Document& document);  // one file that asks nothing of the network

// A section as every other: sentences, plots, tables. Complete without scripts.
std::string section_html(const Section& section);

// What no other format has.
std::string details_html(const Comparison& comparison);
// One article each, with what fields its runs keep.
std::string problems_html(const Comparison& comparison, const AllFields& fields);
std::string methods_html(const Comparison& comparison);     // the grid of properties
std::string optimizers_html(const Comparison& comparison);  // one article each
// What its runs asked for, as counted, not the least that it can do with: "forward, jacobian,
// inverse (on 3 of 20)" settings.
std::string counted_oracles(const Comparison& comparison, std::size_t optimizer);
std::string claims_html(const Document& document);  // verdicts, and each claim with its evidence

// Drawings with their words.
std::string curves_html(const Comparison& comparison, std::size_t problem);
std::string planes_html(const Comparison& comparison, std::size_t problem);
std::string figures_html(const Document& document);
std::vector<std::size_t> first_lines(const Comparison& comparison, std::size_t problem);

// Fields. Bytes 1 to 255, of which 128 is 0 and 255 twice `scale`: colours end at ±scale, and what
// a difference of two may need is not lost before. Beyond twice the scale a value is cut.
std::string field_bytes(const std::vector<float>& values, Real scale);
std::string radix64(std::string_view bytes);  // RFC 4648, section 4
// A byte a cell, painted by the scripts in the colours of a ramp, "grey" or "diverging".
std::string canvas_html(std::string_view bytes, Index rows, Index columns, std::string_view ramp,
                        std::string_view words);
std::string fields_html(const Comparison& comparison, const FoundFields& all);
std::string fields_json(const FoundFields& all);

// The data of the scripts, as JSON that is safe inside a script element.
std::string page_data(const Document& document, const AllFields& fields);
std::string runs_address(const Document& document);  // of the folder of records, from the page
std::string json_quoted(const std::string& text);
// Those that the page can be switched to, in the order of its data.
std::vector<Measure> measures_of(const Comparison& comparison);
// Those of the 51 targets that the page holds medians to: all, but of a study too large for that
// the tolerances of its report alone.
std::vector<std::size_t> targets_of(const Comparison& comparison);
// Whether its page leaves out what would make it too long: commands of cells, which stand in
// report.csv, and curves by other measures than its own.
bool is_large(const Comparison& comparison);
Real tau_of(const Comparison& comparison);  // of the report

// † tells what an optimizer sees that others do not, § that its figures are claims of others; empty
// where neither holds.
std::string marks_html(const OptimizerAxis& axis);

}  // namespace isoline::reports
