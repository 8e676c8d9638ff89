// Where the options of a method came from on each problem: its own defaults, a paper, or the best
// of some values tried. Tables whose figures depend on it say so beside the name.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "core/results/ranking.h"
#include "core/results/study.h"

namespace isoline::reports {

using namespace results;

enum class Origin {
  defaults,   // no rate was set
  given,      // typed, or a suite's
  tuned,      // the best of a grid, on other seeds of this very problem
  published,  // a paper's
  table,      // a table of rates; these results do not say from where it has it
};
inline constexpr std::array<std::string_view, 5> kOriginNames = {
    "at its defaults", "as given", "tuned", "published", "from a table"};
inline std::string_view name_of(Origin origin) {
  return kOriginNames[static_cast<std::size_t>(origin)];
}

// The row of a table of rates that a pair ran with; none where no table had one.
const TunedRate* rate_of(const Comparison& comparison, std::size_t problem, std::size_t optimizer);

Origin origin_of(const Comparison& comparison, std::size_t problem, std::size_t optimizer);

// "3.8e-5, tuned": value and origin; empty where no table chose.
std::string origin_text(const Comparison& comparison, std::size_t problem, std::size_t optimizer);

// "gd (3.8e-5, tuned)", in tables of one problem; the label alone where no table chose.
std::string setting_text(const Comparison& comparison, std::size_t problem, std::size_t optimizer);

// A sentence: how many methods have rates of tables; empty where no run used one.
std::string rates_text(const Comparison& comparison);

}  // namespace isoline::reports
