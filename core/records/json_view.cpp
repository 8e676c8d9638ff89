// Views of JSON values on the tape of simdjson, and schemas by valijson; the only adapter to both.
#include "core/records/json_view.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <simdjson.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/text.h"

namespace isoline {
namespace {

using simdjson::dom::element;
using simdjson::dom::element_type;

static_assert(sizeof(element) == sizeof(JsonView::Place));
element element_at(JsonView::Place place) { return std::bit_cast<element>(place); }
JsonView view_of(const element& value) { return JsonView(std::bit_cast<JsonView::Place>(value)); }

[[noreturn]] void fail(const char* expected, const element& value) {
  constexpr std::size_t kMost = 60;
  throw UsageError(
      fmt::format("expected {}, got {}", expected, cut(simdjson::minify(value), kMost)));
}

template <class Value>
Value checked(const element& value, const char* expected) {
  Value out{};
  if (value.get(out) != simdjson::SUCCESS) fail(expected, value);
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

std::int64_t integer(const element& value) { return checked<std::int64_t>(value, "an integer"); }

simdjson::dom::array array(const element& value) {
  return checked<simdjson::dom::array>(value, "a list");
}

template <class Value, class Read>
void read_all(const element& list, std::vector<Value>& out, Read read) {
  const simdjson::dom::array values = array(list);
  out.clear();
  out.reserve(values.size());
  for (const element value : values) out.push_back(read(value));
}

Json copy_of(const element& value) { return Json::parse(simdjson::minify(value)); }

// Nothing where an element is neither number nor text.
std::optional<Json> outline_of_column(const simdjson::dom::array& column) {
  std::map<element_type, std::pair<element, element>> extremes;
  std::set<std::string_view> texts;
  const auto size = [](const element& number) { return number.get_double().value_unsafe(); };
  for (const element value : column) {
    if (value.is_string()) {
      texts.insert(value.get_string().value_unsafe());
    } else if (value.is_number()) {
      auto& [least, most] = extremes.try_emplace(value.type(), value, value).first->second;
      if (size(value) < size(least)) least = value;
      if (size(value) > size(most)) most = value;
    } else {
      return std::nullopt;
    }
  }
  Json list = Json::array();
  for (const auto& [type, ends] : extremes)
    list.insert(list.end(), {copy_of(ends.first), copy_of(ends.second)});
  for (const std::string_view text : texts) list.push_back(text);
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

// valijson reads integers as signed ones: beyond them a seed would be below zero.
bool is_beyond(const Json& value) {
  return value.is_number_unsigned() &&
         value.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max();
}
bool holds_beyond(const Json& value) {
  if (value.is_structured()) return std::ranges::any_of(value, holds_beyond);
  return is_beyond(value);
}

// valijson's description in our words; empty for what follows from a violation further inside.
std::string in_words(const std::string& description) {
  const auto quoted_at_end = [&] {
    const std::size_t end = description.rfind('\''), begin = description.rfind('\'', end - 1);
    return description.substr(begin, end - begin + 1);
  };
  const auto last_word = [&] {
    const std::string word = description.substr(description.rfind(' ') + 1);
    const std::size_t point = word.find_last_not_of("0.");  // "0.000000"
    return word.find('.') == word.npos ? word : word.substr(0, std::max<std::size_t>(point + 1, 1));
  };
  const auto is = [&](std::string_view begin) { return description.starts_with(begin); };
  if (is("Object contains a property that")) return "unknown member " + quoted_at_end();
  if (is("Missing required property")) return "the member " + quoted_at_end() + " is missing";
  if (is("Value type")) return "a value of another type is expected";
  if (is("Failed to match expected value")) return "another text is expected";
  if (is("Failed to match against any enum")) return "it is not among the known values";
  if (is("Failed to match regex")) return "it does not have the expected form";
  if (is("Failed to validate against any schemas")) return "a value of another form is expected";
  if (is("Failed to validate against exactly one")) return "a value of another form is expected";
  if (is("Expected number greater than or equal")) return "it must be at least " + last_word();
  if (is("Expected number less than or equal")) return "it must be at most " + last_word();
  if (is("Expected number greater")) return "it must be greater than " + last_word();
  if (is("Expected number less")) return "it must be less than " + last_word();
  if (is("Array should") || is("Object should") || is("String should"))
    return "it is too long or too short";
  if (is("Elements at indexes")) return "two of its elements are equal";
  return "";
}

// Reads a text, also with integers beyond 64 bits: programs that write doubles without an exponent
// make them. Such an integer gets an exponent in `longer`, which must live as long as the elements.
simdjson::error_code parse_all(simdjson::dom::parser& parser, const std::string& text,
                               std::string& longer, element& root) {
  constexpr std::size_t kDigits = 19;  // as many always fit
  const simdjson::error_code error = parser.parse(text).get(root);
  if (error != simdjson::NUMBER_ERROR) return error;
  longer.clear();
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i + 1;
    if (text[i] == '"') {
      while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
      end = std::min(end + 1, text.size());
    } else if (text[i] >= '0' && text[i] <= '9') {
      end = std::min(text.find_first_not_of("0123456789.eE+-", i), text.size());
    }
    longer.append(text, i, end - i);
    const bool is_long = end - i > kDigits && text[i] != '"';
    if (is_long && longer.find_first_of(".eE", longer.size() - (end - i)) == longer.npos)
      longer += "e0";
    i = end;
  }
  return parser.parse(longer).get(root);
}

// Whether an object has two members of one name, of which this parser would take the first.
bool has_twins(const element& value) {
  if (simdjson::dom::object object; value.get(object) == simdjson::SUCCESS) {
    std::vector<std::string_view> names;
    for (const auto& [name, member] : object) {
      if (has_twins(member)) return true;
      names.push_back(name);
    }
    std::ranges::sort(names);
    if (std::ranges::adjacent_find(names) != names.end()) return true;
  }
  if (simdjson::dom::array list; value.get(list) == simdjson::SUCCESS)
    for (const element each : list)
      if ((each.is_object() || each.is_array()) && has_twins(each)) return true;
  return false;
}

// Texts that are longer than their schema allows. They are found before any pattern is applied: a
// regular expression takes of the stack for each character.
void add_long_texts(const Json& value, const Json& schema, const Json& root,
                    const std::string& place, std::vector<std::string>& found) {
  if (!schema.is_object()) return;
  if (schema.contains("$ref")) {
    const std::string target = schema["$ref"].get<std::string>().substr(1);
    return add_long_texts(value, root.at(Json::json_pointer(target)), root, place, found);
  }
  if (value.is_string() && schema.contains("maxLength")) {
    const auto most = schema["maxLength"].get<std::size_t>();
    const std::size_t length = value.get_ref<const std::string&>().size();
    if (length > most)
      found.push_back(fmt::format("{}: has {} bytes; at most {} are allowed", place, length, most));
  }
  if (value.is_object() && schema.contains("properties"))
    for (const auto& [name, inner] : schema["properties"].items())
      if (value.contains(name))
        add_long_texts(value[name], inner, root, fmt::format("{}[{}]", place, name), found);
  if (value.is_array() && schema.contains("items"))
    for (std::size_t i = 0; i < value.size(); ++i)
      add_long_texts(value[i], schema["items"], root, fmt::format("{}[{}]", place, i), found);
}

// Larger numbers are replaced by the largest that it reads.
void bring_within(Json& value) {
  if (value.is_structured())
    for (Json& each : value) bring_within(each);
  else if (is_beyond(value))
    value = std::numeric_limits<std::int64_t>::max();
}

}  // namespace

Json outline_of(const std::string& text, const std::string& origin) {
  static thread_local simdjson::dom::parser parser;
  std::string longer;
  element root;
  if (parse_all(parser, text, longer, root) == simdjson::SUCCESS && !has_twins(root))
    return outline(root);
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
  for (const auto& field : checked<simdjson::dom::object>(element_at(place_), "an object"))
    all.emplace_back(field.key, view_of(field.value));
  return all;
}

std::string JsonView::text() const { return simdjson::minify(element_at(place_)); }

std::string reason_of(const std::exception& error) {
  if (const auto* json = dynamic_cast<const Json::exception*>(&error)) {
    const std::string text = json->what();
    const std::size_t begin = text.find("key '"), end = text.rfind('\'');
    return begin != text.npos && end > begin + 4
               ? fmt::format("it has no member {}", text.substr(begin + 4, end - begin - 3))
               : "a member is missing or of another type than expected";
  }
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return fmt::format("{}: {}", file->path1().string(), file->code().message());
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return "out of memory";
  const bool is_ours = dynamic_cast<const UsageError*>(&error) != nullptr ||
                       dynamic_cast<const std::runtime_error*>(&error) != nullptr;
  return is_ours ? error.what() : "an error within Isoline, which should be reported";
}

std::string reason_without(const std::string& file, const std::exception& error) {
  const std::string reason = reason_of(error);
  if (reason.starts_with(file + ": ")) return reason.substr(file.size() + 2);
  return reason.starts_with(file + " ") ? "it" + reason.substr(file.size()) : reason;
}

std::string json_of_text(const std::string& text) { return json_text(Json(text)); }

Json JsonView::json() const { return copy_of(element_at(place_)); }

bool JsonView::is_null() const { return element_at(place_).is_null(); }

void JsonView::get_to(bool& out) const { out = checked<bool>(element_at(place_), "a truth"); }
void JsonView::get_to(std::int64_t& out) const { out = integer(element_at(place_)); }
void JsonView::get_to(std::uint64_t& out) const {
  out = checked<std::uint64_t>(element_at(place_), "an unsigned integer");
}
void JsonView::get_to(int& out) const {
  const element here = element_at(place_);
  const std::int64_t number = integer(here);
  if (number != static_cast<int>(number)) fail("a small integer", here);
  out = static_cast<int>(number);
}
void JsonView::get_to(std::string& out) const {
  out = checked<std::string_view>(element_at(place_), "a text");
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
  std::string longer;
};

JsonReader::JsonReader() : parser_(std::make_unique<Parser>()) {}
JsonReader::~JsonReader() = default;

// The slow parser reports the error and its place.
JsonView JsonReader::parse(const std::string& text, const std::string& origin) {
  element root;
  if (parse_all(parser_->parser, text, parser_->longer, root) == simdjson::SUCCESS &&
      !has_twins(root))
    return view_of(root);
  parse_json(text, origin);
  throw UsageError(origin + " is not JSON: it is not valid UTF-8, or has a number out of range");
}

// Schemas, by valijson.

using Adapter = valijson::adapters::NlohmannJsonAdapter;

struct Schema::Parsed {
  valijson::Schema schema;
  Json text;
};

Schema::Schema(const Json& schema) {
  auto parsed = std::make_unique<Parsed>();
  valijson::SchemaParser().populateSchema(Adapter(schema), parsed->schema);
  parsed->text = schema;
  parsed_ = std::move(parsed);
}

Schema::~Schema() = default;

std::vector<std::string> Schema::violations(const Json& document) const {
  if (holds_beyond(document)) {
    Json within = document;
    bring_within(within);
    return violations(within);
  }
  std::vector<std::string> violations;
  add_long_texts(document, parsed_->text, parsed_->text, "<root>", violations);
  if (!violations.empty()) return violations;
  valijson::ValidationResults results;
  valijson::Validator().validate(parsed_->schema, Adapter(document), &results);
  for (valijson::ValidationResults::Error error; results.popError(error);)
    if (const std::string words = in_words(error.description); !words.empty())
      violations.push_back(fmt::format("{}: {}", fmt::join(error.context, ""), words));
  if (violations.empty() && results.numErrors() > 0)
    violations.emplace_back("<root>: it does not conform");
  return violations;
}

std::vector<std::string> schema_violations(const Json& document, const Json& schema) {
  return Schema(schema).violations(document);
}

}  // namespace isoline
