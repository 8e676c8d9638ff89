// The tables of statistics in each format.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "reports/comparison.h"

namespace isoline::reports {

std::string statistics_html(const Comparison& comparison);
std::string statistics_markdown(const Comparison& comparison);
std::string statistics_latex(const Comparison& comparison);
std::string statistics_csv(const Comparison& comparison);  // table,row,column,value
nlohmann::json statistics_json(const Comparison& comparison);

}  // namespace isoline::reports
