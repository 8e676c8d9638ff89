// What this very data shows: who leads and how sure that is, and one sentence a chart.
#pragma once

#include <string>
#include <vector>

#include "reports/html/curves.h"

namespace isoline::reports {

// Below that many problems nothing is said of an order, and no profile is drawn.
inline constexpr std::size_t kFewProblems = 4;

// One or two sentences: who leads, and who does among those without privileges.
std::vector<std::string> verdict(const Comparison& comparison);
std::string profile_reading(const Comparison& comparison, std::size_t tolerance);
std::string curve_reading(const Comparison& comparison, std::size_t problem);
// Of the paths in x or in y; empty where fewer than two say anything.
std::string path_reading(const Comparison& comparison, std::size_t problem,
                         std::vector<std::vector<Real>> Path::*rows);

}  // namespace isoline::reports
