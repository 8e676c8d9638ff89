// JSON with no byte more than it needs: the page holds figures of every cell.
#pragma once

#include <string>
#include <vector>

#include "core/real.h"

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

}  // namespace isoline::reports
