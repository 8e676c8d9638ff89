// What the page draws, as compact JSON: numbers, medians to the targets, and the data of a problem.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/real.h"
#include "reports/read/found_fields.h"
#include "reports/read/metrics.h"
#include "reports/read/ranking.h"

namespace isoline::reports {

std::string number(Real value);  // as tables have it; null where it is none
std::string coarse(Real value);  // three digits: enough for a curve

// "[a,b,c]" of whatever `item` writes.
template <class Range, class Item>
std::string list(const Range& range, Item item) {
  std::string text = "[";
  for (const auto& one : range) {
    if (text.size() > 1) text += ',';
    text += item(one);
  }
  return text + "]";
}

std::string indices(const std::vector<std::size_t>& all);

// Medians to the 51 targets in as few letters as they need: the page holds them for every cell.

// Comma-separated, of the finite ones; "8*3" is one that stands three times. Counts are halves in
// base 36; costs, and times in seconds, are the digits of a number and a letter for its power of
// ten.
std::string target_codes(const std::vector<Real>& medians, Measure by);

// What the page draws of one problem, as compact JSON.

// Those that the page can be switched to, in the order of its data.
std::vector<Measure> measures_of(const Comparison& comparison);

// Those of the 51 targets that the page holds medians to: all, but of a study too large for that
// the tolerances of its report alone.
std::vector<std::size_t> targets_of(const Comparison& comparison);

std::string problem_data(const Comparison& comparison, const Ladders& ladders, std::size_t problem,
                         const std::optional<FoundFields>& fields);

}  // namespace isoline::reports
