// Kinds of methods as colours, dashes and words.
#include "reports/page/kinds.h"

#include <fmt/format.h>

#include <array>
#include <map>

namespace isoline::reports {
namespace {

const std::map<std::string_view, std::string> kTitles = {{"gradient", "Gradient"},
                                                         {"adaptive", "Adaptive gradient"},
                                                         {"quasi-newton", "Quasi-Newton"},
                                                         {"second-order", "Second order"},
                                                         {"least-squares", "Least squares"},
                                                         {"half-inverse", "Half-inverse gradients"},
                                                         {"inversion", "Inversion of the physics"},
                                                         {"derivative-free", "Derivative-free"}};

constexpr std::array<std::string_view, 5> kDashes = {"none", "7 3", "2 3", "9 3 2 3", "14 4"};
constexpr std::array<int, 3> kShares = {100, 72, 50};  // of the kind's colour; the rest is ink

}  // namespace

std::string kind_title(std::string_view kind) {
  const auto at = kTitles.find(kind);
  return at == kTitles.end() ? "Other" : at->second;
}

std::string kind_rules(const Comparison& c) {
  std::string rules;
  std::map<std::string, std::size_t> counts;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    std::string kind = c.optimizers[s].mathematics();
    if (!kTitles.contains(kind)) kind = "other";
    const std::size_t place = counts[kind]++;
    rules += fmt::format(
        "[data-s=\"{}\"]{{--series:color-mix(in oklab,var(--{}) {}%,var(--ink));--dash:{}}}\n", s,
        kind, kShares[place / kDashes.size() % kShares.size()], kDashes[place % kDashes.size()]);
  }
  return rules;
}

std::string swatch() {
  return "<svg class=swatch viewBox=\"0 0 24 8\" aria-hidden=true><path d=\"M0 4h24\"/></svg>";
}

}  // namespace isoline::reports
