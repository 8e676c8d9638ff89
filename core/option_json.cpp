// Options to JSON and back.
#include "core/option_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/json.h"

namespace isoline {
namespace {

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
    return fmt::format("the option {} is neither number, truth nor text: {}", name,
                       json_text(json));
  });
  return json.get<std::string>();
}

}  // namespace

Json to_json(const OptionValues& options) {
  Json json = Json::object();
  for (const auto& [name, value] : options) json[name] = json_of(value);
  return json;
}

OptionValues option_values_from(const Json& json) {
  require(json.is_object(), [&] { return "options are an object, got " + json_text(json); });
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
    if (field.standard.index() < 2) entry["range"] = text_of(field.range);
    if (!field.choices.empty()) entry["choices"] = field.choices;
    list.push_back(entry);
  }
  return list;
}

}  // namespace isoline
