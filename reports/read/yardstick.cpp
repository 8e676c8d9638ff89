// Names of rungs, and yardsticks of other tolerances.
#include "reports/read/yardstick.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

namespace isoline::reports {
namespace {

// "1e-4", "1.6e-4": two digits tell a rung from its neighbours.
std::string rung_name(std::size_t j) {
  if (j == 0) return "1";
  std::string text = fmt::format("{:.1e}", rung(j));
  if (const std::size_t zero = text.find(".0"); zero != std::string::npos) text.erase(zero, 2);
  if (const std::size_t zero = text.find("e-0"); zero != std::string::npos) text.erase(zero + 2, 1);
  return text;
}

const std::vector<std::string>& rung_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (std::size_t j = 0; j < kRungs; ++j) all.push_back(rung_name(j));
    return all;
  }();
  return names;
}

Tolerance tolerance_of_rung(std::size_t j) { return {rung_names()[j], rung(j), j}; }

}  // namespace

std::optional<Measure> measure_of(std::string_view name) {
  for (const Measure measure : kMeasures)
    if (name_of(measure) == name) return measure;
  return std::nullopt;
}

Tolerance tolerance_at(Real tau) { return tolerance_of_rung(rung_of(tau)); }

// The usual looser ones stay where they are looser; else a third and two thirds of the way down.
Yardstick yardstick_at(Measure by, Real tau) {
  Yardstick yardstick{.by = by};
  const Tolerance last = tolerance_at(tau);
  const bool is_usual = kTolerances[kTightest - 1].rung < last.rung;
  for (std::size_t t = 0; t < kTightest && !is_usual; ++t)
    yardstick.tolerances[t] = tolerance_of_rung((t + 1) * last.rung / kTolerances.size());
  yardstick.tolerances[kTightest] = last;
  return yardstick;
}

}  // namespace isoline::reports
