// Specifications are compared by what they mean, not as text.
#include "core/records/naming.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <variant>
#include <vector>

#include "core/errors.h"
#include "core/spec.h"

namespace isoline {
namespace {

bool has_value(const OptionValue& value, const std::string& text) {
  if (const auto* own = std::get_if<std::string>(&value)) {
    if (*own == text) return true;
    try {  // a value that is a specification itself
      const std::vector<Spec> a = parse_specs(*own), b = parse_specs(text);
      const auto sorted = [](std::vector<std::pair<std::string, std::string>> options) {
        std::ranges::sort(options);
        return options;
      };
      return std::ranges::equal(a, b, [&](const Spec& x, const Spec& y) {
        return x.name == y.name && sorted(x.options) == sorted(y.options);
      });
    } catch (const UsageError&) {
      return false;
    }
  }
  if (const bool* own = std::get_if<bool>(&value)) return text == (*own ? "true" : "false");
  Real number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  if (const Index* own = std::get_if<Index>(&value)) return static_cast<Real>(*own) == number;
  return std::get<Real>(value) == number;
}

}  // namespace

bool is_named(const Component& component, std::string_view text) {
  if (text == component.name || text == component.spec || text == component.asked) return true;
  try {
    const std::vector<Spec> wanted = parse_specs(text);
    return std::ranges::any_of(wanted, [&](const Spec& spec) {
      return spec.name == component.name &&
             std::ranges::all_of(spec.options, [&](const auto& option) {
               const OptionValue* const own = component.options.find(option_name(option.first));
               return own != nullptr && has_value(*own, option.second);
             });
    });
  } catch (const UsageError&) {
    return false;
  }
}

}  // namespace isoline
