// Parts of the HTML page.
#pragma once

#include <string>

#include "reports/comparison.h"
#include "reports/figures.h"

namespace isoline {

// Tables as HTML, complete without scripts.
std::string standings_html(const Comparison& comparison, std::size_t tolerance);
std::string matrix_html(const Comparison& comparison, std::size_t tolerance);
std::string details_html(const Comparison& comparison);
std::string failures_html(const Comparison& comparison);
std::string families_html(const Comparison& comparison);
std::string provenance_html(const Comparison& comparison);

std::string figures_html(const std::vector<Figure>& figures);
std::string figures_json(const std::vector<Figure>& figures);

// What the charts draw, as JSON that is safe inside a script element.
std::string page_data(const Comparison& comparison, const std::vector<Figure>& figures);

}  // namespace isoline
