// One colour a kind of method, in every report; within a kind a dash and a lightness by rank.
#pragma once

#include <string>
#include <string_view>

#include "core/results/ranking.h"

namespace isoline::reports {

using namespace results;

std::string kind_title(std::string_view kind);  // "Adaptive gradients"

// Rules of the style sheet: what has data-s has the colour and dash of that optimizer. No two of a
// kind have both alike, up to fifteen.
std::string kind_rules(const Comparison& comparison);
// A short line in the colour and dash of the element around it.
std::string swatch();

}  // namespace isoline::reports
