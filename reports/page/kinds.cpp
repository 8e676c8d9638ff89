// Kinds of methods as colours, dashes and words.
#include "reports/page/kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>

namespace isoline::reports {
namespace {

// Fowler, Noll, Vo: the same on every machine, and moved by any letter.
std::uint32_t digest_of(std::string_view name) {
  constexpr std::uint32_t kOffset = 2166136261U, kPrime = 16777619U;
  std::uint32_t digest = kOffset;
  for (const char letter : name) digest = (digest ^ static_cast<unsigned char>(letter)) * kPrime;
  return digest ^ digest >> 15U;
}

}  // namespace

LineStyle style_of(const OptimizerAxis& optimizer) {
  const auto at = std::ranges::find(kMathematics, optimizer.mathematics());
  const auto kind =
      std::min<std::ptrdiff_t>(at - kMathematics.begin(), std::ssize(kMathematics) - 1);
  // Settings of a method differ by their options.
  const std::uint32_t method = digest_of(optimizer.method), setting = digest_of(optimizer.label);
  return {static_cast<std::size_t>(kind), method % kDashes.size(), setting % kMarkers};
}

std::string kind_title(std::string_view kind) {
  static const std::map<std::string_view, std::string> kTitles = {
      {"gradient", "Gradient"},
      {"adaptive", "Adaptive gradient"},
      {"quasi-newton", "Quasi-Newton"},
      {"second-order", "Second order"},
      {"least-squares", "Least squares"},
      {"half-inverse", "Half-inverse gradients"},
      {"inversion", "Inversion of the physics"},
      {"derivative-free", "Derivative-free"}};
  const auto at = kTitles.find(kind);
  return at == kTitles.end() ? "Other" : at->second;
}

std::string kind_rules(const Comparison& c) {
  std::string rules;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const LineStyle style = style_of(c.optimizers[s]);
    const std::string_view dash = kDashes[style.dash];
    rules += fmt::format("[data-s=\"{}\"]{{--series:var(--{});--dash:{}}}\n", s,
                         kMathematics[style.kind], dash.empty() ? "none" : dash);
  }
  return rules;
}

std::string swatch() {
  return "<svg class=swatch viewBox=\"0 0 24 8\" aria-hidden=true><path d=\"M0 4h24\"/></svg>";
}

}  // namespace isoline::reports
