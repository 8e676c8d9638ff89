// One sentence a chart: what this very data shows.
#pragma once

#include <string>

#include "reports/comparison.h"

namespace isoline {

std::string profile_reading(const Comparison& comparison, std::size_t tolerance);
std::string curve_reading(const Comparison& comparison, std::size_t problem);
std::string path_reading(const Comparison& comparison, std::size_t problem);  // empty: no paths

}  // namespace isoline
