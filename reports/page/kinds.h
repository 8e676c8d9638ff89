// One colour a kind of method, fixed by its name for ever; within a kind a dash and a marker, fixed
// by the method's name: no chart of another report shows it otherwise.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "reports/read/comparison.h"

namespace isoline::reports {

inline constexpr std::array<std::string_view, 9> kMathematics = {
    "gradient",     "adaptive",  "quasi-newton",    "second-order", "least-squares",
    "half-inverse", "inversion", "derivative-free", "other"};

struct LineStyle {
  std::size_t kind = 0;  // of kMathematics
  std::size_t dash = 0, marker = 0;
};
inline constexpr std::array<std::string_view, 5> kDashes = {"", "7 3", "2 3", "9 3 2 3", "14 4"};
inline constexpr std::size_t kMarkers = 5;
LineStyle style_of(const OptimizerAxis& optimizer);

std::string kind_title(std::string_view kind);  // "Adaptive gradients"

// Rules of the style sheet: what has data-s has the colour and dash of that optimizer.
std::string kind_rules(const Comparison& comparison);
// A short line in the colour and dash of the element around it.
std::string swatch();

}  // namespace isoline::reports
