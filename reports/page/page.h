// The HTML page and its parts. An element with data-s or data-p, the index of an optimizer or
// problem, is hidden where the reader filters that one out; with both, where either is.
#pragma once

#include <string>

#include "reports/read/found_fields.h"
#include "reports/sections/sections.h"
#include "reports/sections/standings.h"

namespace isoline::reports {

std::string html_report(const Document& document);  // one file that asks nothing of the network

// A section as every other: sentences, plots, tables. Complete without scripts.
std::string section_html(const Section& section);
std::string plot_html(const Plot& plot);
std::string plot_svg(const Plot& plot);

// What the scripts redraw, and what no other format has.
std::string overview_html(const Document& document);     // alerts, verdict, what is settled
std::string endings_html(const Comparison& comparison);  // how the runs ended
// With the intervals of scores, which the scripts draw too.
std::string standings_html(const Comparison& comparison, const std::vector<Interval>& intervals);
std::string heat_html(const Comparison& comparison);  // what each took on each problem, by kind
std::string details_html(const Comparison& comparison);
// One article each, with what fields its runs keep.
std::string problems_html(const Comparison& comparison, const AllFields& fields);
std::string methods_html(const Comparison& comparison);     // the grid of properties
std::string optimizers_html(const Comparison& comparison);  // one article each
std::string figures_html(const Document& document);
std::string claims_html(const Document& document);  // verdicts, and each claim with its evidence

// What the charts draw, as JSON that is safe inside a script element.
std::string page_data(const Document& document, const std::vector<Interval>& intervals,
                      const AllFields& fields);
inline constexpr std::size_t kShownAtFirst = 12;  // of the standings; the others on demand
std::string figures_json(const std::vector<Figure>& figures);
std::string json_quoted(const std::string& text);

// † tells what an optimizer sees that others do not, § that its figures are claims of others; empty
// where neither holds.
std::string marks_html(const OptimizerAxis& axis);

}  // namespace isoline::reports
