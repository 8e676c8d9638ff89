// Checks, completes, describes and abbreviates options.
#include "core/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/json.h"
#include "core/spec.h"
#include "core/text.h"

namespace isoline {
namespace {

bool parses_whole(const std::string& text, auto& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

std::optional<Real> number_in(const OptionValue& value) {
  if (const Real* real = std::get_if<Real>(&value)) return *real;
  if (const Index* whole = std::get_if<Index>(&value)) return static_cast<Real>(*whole);
  return std::nullopt;
}

// One field's value in the field's type, or UsageError.
class FieldParser {
 public:
  FieldParser(const std::string& component, const OptionField& field, const OptionValue& given)
      : component_(component), field_(field), given_(given) {}

  OptionValue operator()(Real) const { return within(number()); }
  OptionValue operator()(Index) const {
    const Real value = number();
    if (value != std::floor(value) || std::abs(value) > 1e15) reject("a whole number");
    return static_cast<Index>(within(value));
  }
  OptionValue operator()(bool) const {
    if (std::holds_alternative<bool>(given_)) return given_;
    const std::string* text = std::get_if<std::string>(&given_);
    if (text && (*text == "true" || *text == "yes" || *text == "1")) return true;
    if (text && (*text == "false" || *text == "no" || *text == "0")) return false;
    reject("true or false");
  }
  OptionValue operator()(const std::string&) const {
    const std::string* value = std::get_if<std::string>(&given_);
    if (!value) reject("text");
    const bool is_known = std::ranges::find(field_.choices, *value) != field_.choices.end();
    if (!field_.choices.empty() && !is_known) {
      Choices named = field_.choices;
      std::erase(named, "");  // the choice of nothing has no name
      reject(fmt::format("one of {}", fmt::join(named, ", ")),
             nearest_name(*value, field_.choices));
    }
    return *value;
  }

 private:
  Real number() const {
    if (const std::optional<Real> value = number_in(given_)) return *value;
    const std::string* text = std::get_if<std::string>(&given_);
    Real value = 0;
    if (!text || !parses_whole(*text, value) || std::isnan(value)) reject("a number");
    return value;
  }
  Real within(Real value) const {
    if (!isoline::contains(field_.range, value)) reject("in " + range_text(field_.range));
    return value + 0.0;  // −0 as 0: both are one setting
  }
  [[noreturn]] void reject(const std::string& law, const std::string& nearest = "") const {
    std::string text =
        fmt::format("{}: {} must be {}, got {}", component_, field_.name, law, option_text(given_));
    if (!nearest.empty()) text += fmt::format("; did you mean {}?", nearest);
    throw UsageError(text);
  }

  const std::string& component_;
  const OptionField& field_;
  const OptionValue& given_;
};

Json json_of(const OptionValue& option) {
  return std::visit(
      [](const auto& value) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Real>)
          return json_number(value);
        else
          return value;
      },
      option);
}

OptionValue option_from(const std::string& name, const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_integer()) return json.get<Index>();
  if (json.is_number()) return json.get<Real>();
  require(json.is_string(), [&] {
    return fmt::format("the option {} must be a number, true or false, or a string, got {}", name,
                       json_text(json));
  });
  return json.get<std::string>();
}

}  // namespace

bool contains(const Range& range, Real value) {
  const bool above = range.low_is_open ? value > range.low : value >= range.low;
  const bool below = range.high_is_open ? value < range.high : value <= range.high;
  return above && below && std::isfinite(value);  // no range is closed at infinity
}

std::string range_text(const Range& range) {
  const bool is_closed = std::isfinite(range.high) && !range.high_is_open;
  const bool from_below = std::isfinite(range.low);
  return fmt::format("{}{}, {}{}", range.low_is_open || !from_below ? "(" : "[", range.low,
                     range.high, is_closed ? "]" : ")");
}

std::string option_text(const OptionValue& value) {
  return std::visit([](const auto& held) { return fmt::format("{}", held); }, value);
}

const OptionValue* OptionValues::find(std::string_view name) const {
  const auto found = std::ranges::lower_bound(values_, name, {}, &NamedOption::name);
  return found != values_.end() && found->name == name ? &found->value : nullptr;
}

const OptionValue& OptionValues::at(std::string_view name) const {
  const OptionValue* found = find(name);
  require(found != nullptr, [&] { return fmt::format("unknown option {}", name); });
  return *found;
}

Real OptionValues::number(std::string_view name, Real otherwise) const {
  const OptionValue* found = find(name);
  return found ? number_in(*found).value_or(otherwise) : otherwise;
}

std::string OptionValues::text(std::string_view name, std::string_view otherwise) const {
  const OptionValue* found = find(name);
  const std::string* value = found ? std::get_if<std::string>(found) : nullptr;
  return value ? *value : std::string(otherwise);
}

void OptionValues::set(std::string_view name, OptionValue value) {
  const auto place = std::ranges::lower_bound(values_, name, {}, &NamedOption::name);
  if (place != values_.end() && place->name == name)
    place->value = std::move(value);
  else
    values_.insert(place, {std::string(name), std::move(value)});
}

void OptionValues::set_all(const OptionValues& others) {
  for (const NamedOption& each : others) set(each.name, each.value);
}

void OptionValues::erase(std::string_view name) {
  std::erase_if(values_, [&](const NamedOption& each) { return each.name == name; });
}

std::string_view option_name(std::string_view given) {
  if (given == "lr") return "rate";
  return given == "way" ? "factorization" : given;
}

OptionValues complete_options(const OptionTable& table, const std::string& component,
                              const OptionValues& given) {
  OptionValues complete;
  std::vector<std::string> names;
  for (const OptionField& field : table) {
    names.push_back(field.name);
    complete.set(field.name, field.standard);
  }
  for (const auto& [key, value] : given) {
    const std::string name(option_name(key));
    const auto field = std::ranges::find(table, name, &OptionField::name);
    if (names.empty())
      throw UsageError(fmt::format("{} does not have options, got '{}'", component, key));
    if (field == table.end())
      throw UsageError(component + ": " + unknown_name("option", name, names));
    complete.set(name, std::visit(FieldParser(component, *field, value), field->standard));
  }
  return complete;
}

std::string short_spec(const OptionTable& table, const std::string& name,
                       const OptionValues& options) {
  std::vector<std::string> given;
  for (const OptionField& field : table) {
    const OptionValue& value = options.at(field.name);
    if (value == field.standard) continue;
    const std::string* text = std::get_if<std::string>(&value);
    given.push_back(field.name + "=" + (text ? quoted(*text) : option_text(value)));
  }
  return given.empty() ? name : fmt::format("{}[{}]", name, fmt::join(given, ","));
}

// Options to JSON and back.

Json to_json(const OptionValues& options) {
  Json json = Json::object();
  for (const auto& [name, value] : options) json[name] = json_of(value);
  return json;
}

OptionValues option_values_from(const Json& json) {
  require(json.is_object(), [&] { return "options must be an object, got " + json_text(json); });
  OptionValues options;
  for (const auto& [name, value] : json.items()) options.set(name, option_from(name, value));
  return options;
}

OptionValues without_empty(const OptionValues& options) {
  OptionValues kept = options;
  for (const auto& [name, value] : options)
    if (const auto* text = std::get_if<std::string>(&value); text && text->empty())
      kept.erase(name);
  return kept;
}

Json describe_options(const OptionTable& table) {
  static const char* const kTypes[] = {"number", "integer", "boolean", "text"};
  Json list = Json::array();
  for (const OptionField& field : table) {
    Json entry{{"name", field.name},
               {"type", kTypes[field.standard.index()]},
               {"default", json_of(field.standard)},
               {"doc", field.doc}};
    if (field.standard.index() < 2) entry["range"] = range_text(field.range);
    if (!field.choices.empty()) entry["choices"] = field.choices;
    list.push_back(entry);
  }
  return list;
}

}  // namespace isoline
