// Numbers of the page's data.
#include "reports/page/compact_json.h"

#include <fmt/format.h>

#include <cmath>

#include "reports/sections/words.h"

namespace isoline::reports {

std::string number(Real value) { return std::isfinite(value) ? figure(value) : "null"; }
std::string coarse(Real value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "null";
}

std::string indices(const std::vector<std::size_t>& all) {
  return list(all, [](std::size_t index) { return std::to_string(index); });
}

}  // namespace isoline::reports
