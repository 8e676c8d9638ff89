// Options: checked, completed, described and written in short.
#include "core/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/suggest.h"

namespace isoline {
namespace {

bool parses_whole(const std::string& text, auto& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

// One field's value in canonical type, or UsageError.
class FieldParser {
 public:
  FieldParser(const std::string& component, const OptionField& field, const Json& given)
      : component_(component), field_(field), given_(given) {}

  Json operator()(Real) const {
    const Real value = number();
    if (!contains(field_.range, value)) reject("in " + text_of(field_.range));
    return json_number(value);
  }
  Json operator()(Index) const {
    const Real value = number();
    if (value != std::floor(value) || std::abs(value) > 1e15) reject("a whole number");
    if (!contains(field_.range, value)) reject("in " + text_of(field_.range));
    return static_cast<std::int64_t>(value);
  }
  Json operator()(bool) const {
    if (given_.is_boolean()) return given_;
    if (given_ == "true" || given_ == "yes" || given_ == "1") return true;
    if (given_ == "false" || given_ == "no" || given_ == "0") return false;
    reject("true or false");
  }
  Json operator()(const std::string&) const {
    if (!given_.is_string()) reject("text");
    const auto value = given_.get<std::string>();
    const bool is_known = std::ranges::find(field_.choices, value) != field_.choices.end();
    if (!field_.choices.empty() && !is_known)
      reject(fmt::format("one of {}", fmt::join(field_.choices, ", ")),
             nearest_name(value, field_.choices));
    return value;
  }

 private:
  Real number() const {
    if (given_.is_number()) return given_.get<Real>();
    Real value = 0;
    if (!given_.is_string() || !parses_whole(given_.get<std::string>(), value)) reject("a number");
    if (std::isnan(value)) reject("a number");
    return value;
  }
  [[noreturn]] void reject(const std::string& law, const std::string& nearest = "") const {
    const std::string got = given_.is_string() ? given_.get<std::string>() : given_.dump();
    std::string text = fmt::format("{}: {} must be {}, got {}", component_, field_.name, law, got);
    if (!nearest.empty()) text += fmt::format("; did you mean {}?", nearest);
    throw UsageError(text);
  }

  const std::string& component_;
  const OptionField& field_;
  const Json& given_;
};

Json standard_of(const OptionField& field) {
  return std::visit(
      [](const auto& value) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Real>)
          return json_number(value);
        else
          return value;
      },
      field.standard);
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.is_number_float() ? fmt::format("{}", value.get<Real>()) : value.dump();
}

}  // namespace

bool contains(const Range& range, Real value) {
  const bool above = range.low_is_open ? value > range.low : value >= range.low;
  return above && value <= range.high;
}

std::string text_of(const Range& range) {
  const bool is_bounded = std::isfinite(range.high), from_below = std::isfinite(range.low);
  return fmt::format("{}{}, {}{}", range.low_is_open || !from_below ? "(" : "[", range.low,
                     range.high, is_bounded ? "]" : ")");
}

Json complete_options(const OptionTable& table, const std::string& component, const Json& given) {
  Json complete = Json::object();
  std::vector<std::string> names;
  for (const OptionField& field : table) {
    names.push_back(field.name);
    complete[field.name] = standard_of(field);
  }
  for (const auto& [key, value] : given.items()) {
    const std::string name = key == "lr" ? "rate" : key;
    const auto field = std::ranges::find(table, name, &OptionField::name);
    if (names.empty()) throw UsageError(fmt::format("{} has no options, got {}", component, key));
    if (field == table.end())
      throw UsageError(component + ": " + unknown_name("option", name, names));
    complete[name] = std::visit(FieldParser(component, *field, value), field->standard);
  }
  return complete;
}

Json describe_options(const OptionTable& table) {
  static const char* const kTypes[] = {"number", "integer", "boolean", "text"};
  Json list = Json::array();
  for (const OptionField& field : table) {
    Json entry{{"name", field.name},
               {"type", kTypes[field.standard.index()]},
               {"default", standard_of(field)},
               {"doc", field.doc}};
    if (field.standard.index() < 2) entry["range"] = text_of(field.range);
    if (!field.choices.empty()) entry["choices"] = field.choices;
    list.push_back(entry);
  }
  return list;
}

std::string short_spec(const OptionTable& table, const std::string& name, const Json& options) {
  std::vector<std::string> given;
  for (const OptionField& field : table) {
    const Json& value = options.at(field.name);
    if (value != standard_of(field)) given.push_back(field.name + "=" + text_of(value));
  }
  return given.empty() ? name : fmt::format("{}[{}]", name, fmt::join(given, ","));
}

void OptionReader::operator()(const char* name, Real& value, const Range&, const char*) {
  value = real_of(json_.at(name));
}
void OptionReader::operator()(const char* name, Index& value, const Range&, const char*) {
  value = json_.at(name).get<Index>();
}
void OptionReader::operator()(const char* name, bool& value, const char*) {
  value = json_.at(name).get<bool>();
}
void OptionReader::operator()(const char* name, std::string& value, const Choices&, const char*) {
  value = json_.at(name).get<std::string>();
}

}  // namespace isoline
