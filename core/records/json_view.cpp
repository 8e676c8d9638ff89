// Places in a tree of nlohmann-json.
#include "core/records/json_view.h"

#include <fmt/format.h>
#include <simdjson.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/schema.h"
#include "core/text.h"

namespace isoline {

JsonPlace JsonPlace::operator[](std::string_view member) const {
  return JsonPlace((*here_)[std::string(member)]);
}
JsonPlace JsonPlace::next() const {
  here_->push_back(nullptr);
  return JsonPlace(here_->back());
}
void JsonPlace::make_object() const { *here_ = Json::object(); }
void JsonPlace::make_list() const { *here_ = Json::array(); }
void JsonPlace::set_null() const { *here_ = nullptr; }
void JsonPlace::set(bool value) const { *here_ = value; }
void JsonPlace::set(std::int64_t value) const { *here_ = value; }
void JsonPlace::set(std::uint64_t value) const { *here_ = value; }
void JsonPlace::set(std::string_view value) const { *here_ = valid_utf8(value); }
void JsonPlace::set(Real value) const { *here_ = json_number(value); }
void JsonPlace::set(std::span<const Real> values) const { *here_ = json_numbers(values); }
void JsonPlace::set(Json value) const { *here_ = std::move(value); }

void JsonPlace::parse(std::string_view text) const { *here_ = Json::parse(text); }
void JsonPlace::include(std::string_view text) const { here_->update(Json::parse(text)); }
void JsonPlace::restrict(std::string_view law) const {
  if (here_->contains("$ref"))
    *here_ = {{"allOf", {*here_, Json::parse(law)}}};
  else
    include(law);
}

// Values of JSON as simdjson leaves them on its tape.

namespace {

using simdjson::dom::element;
using simdjson::dom::element_type;

static_assert(sizeof(element) == sizeof(JsonView::Place));
element element_at(JsonView::Place place) { return std::bit_cast<element>(place); }
JsonView view_of(const element& value) { return JsonView(std::bit_cast<JsonView::Place>(value)); }

[[noreturn]] void fail(const char* expected, const element& value) {
  throw UsageError(fmt::format("expected {}, got {}", expected, simdjson::minify(value)));
}

// The value, or what was expected instead.
template <class Value>
Value checked(simdjson::simdjson_result<Value> result, const char* expected, const element& value) {
  Value out{};
  if (std::move(result).get(out) != simdjson::SUCCESS) fail(expected, value);
  return out;
}

Real real(const element& value) {
  double number = 0;
  if (value.get(number) == simdjson::SUCCESS) return number;
  std::string_view text;
  if (value.get(text) != simdjson::SUCCESS) fail("a number", value);
  if (text == "nan") return std::nan("");
  if (text == "inf") return std::numeric_limits<Real>::infinity();
  if (text == "-inf") return -std::numeric_limits<Real>::infinity();
  fail("a number", value);
}

std::int64_t integer(const element& value) {
  return checked(value.get_int64(), "an integer", value);
}

simdjson::dom::array array(const element& value) {
  return checked(value.get_array(), "a list", value);
}

template <class Value, class Read>
void read_all(const element& list, std::vector<Value>& out, Read read) {
  const simdjson::dom::array values = array(list);
  out.clear();
  out.reserve(values.size());
  for (const element value : values) out.push_back(read(value));
}

Json copy_of(const element& value);

Json copy_of(const simdjson::dom::object& object) {
  Json json = Json::object();
  for (const auto& field : object) json.emplace(std::string(field.key), copy_of(field.value));
  return json;
}

Json copy_of(const simdjson::dom::array& list) {
  Json json = Json::array();
  for (const element value : list) json.push_back(copy_of(value));
  return json;
}

Json copy_of(const element& value) {
  switch (value.type()) {
    case element_type::OBJECT:
      return copy_of(value.get_object().value_unsafe());
    case element_type::ARRAY:
      return copy_of(value.get_array().value_unsafe());
    case element_type::STRING:
      return std::string(value.get_string().value_unsafe());
    case element_type::INT64: {
      const std::int64_t number = value.get_int64().value_unsafe();
      return number < 0 ? Json(number) : Json(static_cast<std::uint64_t>(number));
    }
    case element_type::UINT64:
      return value.get_uint64().value_unsafe();
    case element_type::DOUBLE:
      return value.get_double().value_unsafe();
    case element_type::BOOL:
      return value.get_bool().value_unsafe();
    case element_type::NULL_VALUE:
      break;
  }
  return nullptr;
}

// Nothing where an element is neither number nor text.
std::optional<Json> outline_of_column(const simdjson::dom::array& column) {
  std::map<element_type, std::pair<Json, Json>> extremes;
  std::set<std::string_view> texts;
  for (const element value : column) {
    if (value.is_string()) {
      texts.insert(value.get_string().value_unsafe());
    } else if (value.is_number()) {
      const Json number = copy_of(value);
      auto& [least, most] = extremes.try_emplace(value.type(), number, number).first->second;
      if (number < least) least = number;
      if (number > most) most = number;
    } else {
      return std::nullopt;
    }
  }
  Json list = Json::array();
  for (const auto& [type, ends] : extremes) list.insert(list.end(), {ends.first, ends.second});
  for (const std::string_view text : texts) list.push_back(std::string(text));
  return list;
}

Json outline(const element& value) {
  constexpr std::size_t kLong = 8;
  Json json;
  if (simdjson::dom::object object; value.get(object) == simdjson::SUCCESS) {
    json = Json::object();
    for (const auto& field : object) json.emplace(std::string(field.key), outline(field.value));
    return json;
  }
  simdjson::dom::array list;
  if (value.get(list) != simdjson::SUCCESS) return copy_of(value);
  if (list.size() > kLong)
    if (std::optional<Json> column = outline_of_column(list)) return std::move(*column);
  json = Json::array();
  for (const element each : list) json.push_back(outline(each));
  return json;
}

}  // namespace

Json outline_of(const std::string& text, const std::string& origin) {
  static thread_local simdjson::dom::parser parser;
  element root;
  if (parser.parse(text).get(root) == simdjson::SUCCESS) return outline(root);
  return parse_json(text, origin);
}

JsonView JsonView::at(std::string_view key) const {
  element found;
  if (element_at(place_)[key].get(found) != simdjson::SUCCESS)
    throw UsageError(fmt::format("it has no \"{}\"", key));
  return view_of(found);
}

bool JsonView::contains(std::string_view key) const {
  return element_at(place_)[key].error() == simdjson::SUCCESS;
}

std::vector<JsonView> JsonView::values() const {
  std::vector<JsonView> all;
  for (const element value : array(element_at(place_))) all.push_back(view_of(value));
  return all;
}

std::vector<std::pair<std::string, JsonView>> JsonView::items() const {
  std::vector<std::pair<std::string, JsonView>> all;
  const element here = element_at(place_);
  for (const auto& field : checked(here.get_object(), "an object", here))
    all.emplace_back(field.key, view_of(field.value));
  return all;
}

std::string JsonView::text() const { return simdjson::minify(element_at(place_)); }

std::string JsonView::tree_text() const { return json_text(json()); }

std::string json_of_text(const std::string& text) { return json_text(Json(text)); }

Json JsonView::json() const { return copy_of(element_at(place_)); }

bool JsonView::is_null() const { return element_at(place_).is_null(); }

void JsonView::get_to(bool& out) const {
  const element here = element_at(place_);
  out = checked(here.get_bool(), "a truth", here);
}
void JsonView::get_to(std::int64_t& out) const { out = integer(element_at(place_)); }
void JsonView::get_to(std::uint64_t& out) const {
  const element here = element_at(place_);
  out = checked(here.get_uint64(), "an unsigned integer", here);
}
void JsonView::get_to(int& out) const {
  const element here = element_at(place_);
  const std::int64_t number = integer(here);
  if (number != static_cast<int>(number)) fail("a small integer", here);
  out = static_cast<int>(number);
}
void JsonView::get_to(std::string& out) const {
  const element here = element_at(place_);
  out = checked(here.get_string(), "a text", here);
}
void JsonView::get_to(std::vector<std::int64_t>& out) const {
  read_all(element_at(place_), out, integer);
}
void JsonView::get_to(std::vector<std::string>& out) const {
  read_all(element_at(place_), out,
           [](const element& value) { return view_of(value).get<std::string>(); });
}
Real real_of(const JsonView& value) { return real(element_at(value.place_)); }

std::vector<Real> reals_of(const JsonView& list) {
  std::vector<Real> values;
  read_all(element_at(list.place_), values, real);
  return values;
}

struct JsonReader::Parser {
  simdjson::dom::parser parser;
};

JsonReader::JsonReader() : parser_(std::make_unique<Parser>()) {}
JsonReader::~JsonReader() = default;

// The slow parser reports the error and its place.
JsonView JsonReader::parse(const std::string& text, const std::string& origin) {
  element root;
  const simdjson::error_code error = parser_->parser.parse(text).get(root);
  if (error == simdjson::SUCCESS) return view_of(root);
  parse_json(text, origin);
  throw UsageError(fmt::format("{} is not JSON: {}", origin, simdjson::error_message(error)));
}

}  // namespace isoline
