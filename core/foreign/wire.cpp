// Names of what frames ask.
#include "core/foreign/wire.h"

#include <algorithm>
#include <array>
#include <utility>

namespace isoline {
namespace {

constexpr std::array<std::pair<Verb, std::string_view>, 18> kNames{{
    {Verb::hello, "hello"},
    {Verb::linearize, "linearize"},
    {Verb::pushforward, "pushforward"},
    {Verb::pullback, "pullback"},
    {Verb::jacobian, "jacobian"},
    {Verb::inverse, "inverse"},
    {Verb::begin, "begin"},
    {Verb::value, "value"},
    {Verb::gradient, "gradient"},
    {Verb::value_and_gradient, "value_and_gradient"},
    {Verb::residual, "residual"},
    {Verb::jacobian_of_r, "jacobian"},
    {Verb::pushforward_of_r, "pushforward"},
    {Verb::pullback_of_r, "pullback"},
    {Verb::hessian_product, "hessian_product"},
    {Verb::report, "report"},
    {Verb::finish, "finish"},
    {Verb::claim, "claim"},
}};

}  // namespace

std::string_view name_of(Verb verb) {
  const auto* const found =
      std::ranges::find(kNames, verb, &std::pair<Verb, std::string_view>::first);
  return found == kNames.end() ? "an unknown verb" : found->second;
}

}  // namespace isoline
