// Parts of the HTML page. An element with data-s or data-p, the index of an optimizer or problem,
// is hidden where the reader filters that one out; with both, where either is.
#pragma once

#include <string>

#include "reports/comparison.h"
#include "reports/figures/figures.h"

namespace isoline::reports {

// Tables as HTML, complete without scripts.
std::string standings_html(const Comparison& comparison);
std::string matrix_html(const Comparison& comparison);
std::string details_html(const Comparison& comparison);
std::string failures_html(const Comparison& comparison);
std::string glance_html(const Comparison& comparison);      // the first screen
std::string problems_html(const Comparison& comparison);    // one section each
std::string optimizers_html(const Comparison& comparison);  // one section each
std::string provenance_html(const Comparison& comparison);

// A dagger that tells what an optimizer sees; empty where it sees no more than others.
std::string dagger(const std::vector<std::string>& privileges);

std::string family_title(const std::string& family);

std::string figures_html(const Comparison& comparison, const std::vector<Figure>& figures);
std::string figures_json(const std::vector<Figure>& figures);

// What the charts draw, as JSON that is safe inside a script element.
std::string page_data(const Comparison& comparison, const std::vector<Figure>& figures);

}  // namespace isoline::reports
