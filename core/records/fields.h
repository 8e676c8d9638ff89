// The contents of a file, declared once: a struct names its members, and is written as JSON, read
// and described by a JSON Schema from that alone.
//
//   void fields(Like<Summary> auto& summary, auto& field) {
//     field("loss", summary.loss);                       // must be there
//     field("seed", summary.seed, R"({"minimum": 0})");  // with a further law, as JSON Schema
//     field.optional("counts", summary.counts);          // left out where empty
//   }
//
// Each member type defines its JSON form below.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/errors.h"
#include "core/json.h"
#include "core/options.h"
#include "core/oracle.h"
#include "core/records/json_view.h"
#include "core/records/part.h"
#include "core/status.h"
#include "core/text.h"

namespace isoline {

// JSON, written from left to right: some three times as fast as a tree. Canonical text is that of
// json_text(): the keys of an object are sorted, and numbers are as the library prints them.
class JsonText {
 public:
  JsonText() = default;
  // Canonical, without the members of these paths, such as "summary/loss".
  explicit JsonText(const std::set<std::string>& left_out) : left_out_(&left_out) {}

  void raw(std::string_view json) {  // a whole value
    if (needs_comma_) text_ += ',';
    text_ += json;
    needs_comma_ = true;
  }
  void text(std::string_view value) {
    const auto is_plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
    if (!std::ranges::all_of(value, is_plain)) return raw(json_of_text(valid_utf8(value)));
    raw("\"");
    text_.append(value).push_back('"');
  }
  // Also infinite, or not a number. Another reader takes no double for an integer.
  void number(Real value) {
    if (!std::isfinite(value)) return raw(json_text(json_number(value)));
    char digits[64];
    if (left_out_ != nullptr)
      return raw({digits, nlohmann::detail::to_chars(digits, std::end(digits), value)});
    const std::string_view shortest(digits,
                                    std::to_chars(digits, std::end(digits), value).ptr - digits);
    raw(shortest);
    if (shortest.find_first_of(".e") == std::string_view::npos) text_ += ".0";
  }
  void integer(std::integral auto value) {
    char digits[24];
    raw({digits,
         static_cast<std::size_t>(std::to_chars(digits, std::end(digits), value).ptr - digits)});
  }
  void key(std::string_view name) {
    if (left_out_ != nullptr)
      objects_.back().members.emplace_back(name, text_.size() + (needs_comma_ ? 1 : 0));
    text(name);
    text_ += ':';
    needs_comma_ = false;
  }
  void begin(char bracket) {
    raw({&bracket, 1});
    needs_comma_ = false;
    if (left_out_ == nullptr || bracket != '{') return;
    const bool is_first = objects_.empty();
    objects_.push_back(
        {is_first ? "" : objects_.back().path + objects_.back().members.back().first + "/", {}});
  }
  void end(char bracket) {
    if (left_out_ != nullptr && bracket == '}') sort_members();
    text_ += bracket;
    needs_comma_ = true;
  }
  std::string take() { return std::move(text_); }
  // The text of each member of a canonical object, by its name.
  std::map<std::string, std::string> take_members() { return std::move(members_); }

 private:
  struct Object {
    std::string path;  // of the member that it is, with a slash
    std::vector<std::pair<std::string, std::size_t>> members;  // the names, and where each begins
  };

  void sort_members() {
    const Object object = std::move(objects_.back());
    objects_.pop_back();
    if (object.members.empty()) return;
    const std::size_t first = object.members.front().second;
    const std::string unsorted = text_.substr(first);
    std::map<std::string_view, std::string_view> sorted;
    for (std::size_t i = 0; i < object.members.size(); ++i) {
      const auto& [name, at] = object.members[i];
      const bool is_last = i + 1 == object.members.size();
      const std::size_t end = is_last ? text_.size() : object.members[i + 1].second - 1;
      if (!left_out_->contains(object.path + name))
        sorted.emplace(name, std::string_view(unsorted).substr(at - first, end - at));
    }
    text_.resize(first);
    for (const auto& [name, member] : sorted) text_.append(member).push_back(',');
    if (!sorted.empty()) text_.pop_back();
    if (objects_.empty()) members_ = {sorted.begin(), sorted.end()};
  }

  std::string text_;
  bool needs_comma_ = false;
  const std::set<std::string>* left_out_ = nullptr;  // where the text is canonical
  std::vector<Object> objects_;                      // those that are open
  std::map<std::string, std::string> members_;
};

// The JSON form of a type's values: write(value, out), read(view, value), law(out), its schema.
template <class Type>
struct Form;

// An optional member is written as what it holds; one that must be there may also be null.
template <class Value>
decltype(auto) held(Value& value) {
  if constexpr (requires { value.has_value(); })
    return (*value);
  else
    return (value);
}
template <class Value>
using FormOfHeld = Form<std::remove_cvref_t<decltype(held(std::declval<Value&>()))>>;

template <class Value>
bool is_absent(const Value& value) {
  if constexpr (requires { value.has_value(); })
    return !value.has_value();
  else if constexpr (requires { value.empty(); })
    return value.empty();
  else
    return value == Value{};
}

// How a member stands in a file. Our programs always write an `expected` one, but a record may lack
// it; the same holds of a `forgiven` one, which is written where it is empty, too.
enum class Presence { always, forgiven, expected, optional };

// The calls of fields(); each use defines member().
template <class Use>
class Fields {
 public:
  template <class Value>
  void operator()(const char* name, Value&& value, const char* law = "") {
    use().template member<Presence::always>(name, value, law);
  }
  template <class Value>
  void optional(const char* name, Value& value, const char* law = "") {
    use().template member<Presence::optional>(name, value, law);
  }
  template <class Value>
  void expected(const char* name, Value& value, const char* law = "") {
    use().template member<Presence::expected>(name, value, law);
  }
  template <class Value>
  void forgiven(const char* name, Value& value, const char* law = "") {
    use().template member<Presence::forgiven>(name, value, law);
  }
  void allow_others() {}  // by the schema: members that are not declared

 private:
  Use& use() { return static_cast<Use&>(*this); }
};

class FieldWriter : public Fields<FieldWriter> {
 public:
  static constexpr bool kReads = false, kWrites = true;
  explicit FieldWriter(JsonText& out) : out_(out) { out_.begin('{'); }
  ~FieldWriter() { out_.end('}'); }
  FieldWriter(const FieldWriter&) = delete;
  FieldWriter& operator=(const FieldWriter&) = delete;

  template <Presence presence, class Value>
  void member(const char* name, const Value& value, const char*) {
    if constexpr (presence <= Presence::forgiven) {
      out_.key(name);
      Form<Value>::write(value, out_);
    } else if (!is_absent(value)) {
      out_.key(name);
      FormOfHeld<const Value>::write(held(value), out_);
    }
  }
  void constant(const char* name, const char* value) {
    out_.key(name);
    out_.text(value);
  }
  template <class Members>
  void group(const char* name, Members members) {
    out_.key(name);
    FieldWriter inner(out_);
    members(inner);
  }

 private:
  JsonText& out_;
};

class FieldReader : public Fields<FieldReader> {
 public:
  static constexpr bool kReads = true, kWrites = false;
  explicit FieldReader(const JsonView& in) : in_(in) {}

  template <Presence presence, class Value>
  void member(const char* name, Value& value, const char*) {
    if (presence != Presence::always && !in_.contains(name)) return;
    if constexpr (presence <= Presence::forgiven) {
      Form<Value>::read(in_.at(name), value);
    } else {
      if constexpr (requires { value.has_value(); }) value.emplace();
      FormOfHeld<Value>::read(in_.at(name), held(value));
    }
  }
  void constant(const char* name, const char* value) {
    require(in_.at(name).get<std::string>() == value, "it has another schema");
  }
  template <class Members>
  void group(const char* name, Members members) {
    const JsonView view = in_.at(name);
    FieldReader inner(view);
    members(inner);
  }

 private:
  const JsonView& in_;
};

class FieldSchema : public Fields<FieldSchema> {
 public:
  static constexpr bool kReads = false, kWrites = false;
  explicit FieldSchema(Json& out) : out_(out) {
    out_ = {{"type", "object"},
            {"required", Json::array()},
            {"properties", Json::object()},
            {"additionalProperties", false}};
  }

  // A constraint that refers to a definition is complete in itself.
  template <Presence presence, class Value>
  void member(const char* name, const Value&, const char* law) {
    Json& place = place_of(name, presence != Presence::optional);
    if constexpr (presence <= Presence::forgiven)
      Form<Value>::law(place);
    else
      FormOfHeld<const Value>::law(place);
    if (*law == '\0') return;
    if (place.contains("$ref"))
      place = {{"allOf", {place, Json::parse(law)}}};
    else
      place.update(Json::parse(law));
  }
  void constant(const char* name, const char* value) { place_of(name, true)["const"] = value; }
  void allow_others() { out_["additionalProperties"] = true; }

 private:
  Json& place_of(const char* name, bool is_required) const {
    if (is_required) out_["required"].push_back(name);
    return out_["properties"][name];
  }

  Json& out_;
};

// Structs that name their members.
template <class Type>
concept Declared = requires(Type& value, FieldSchema& field) {
  fields(value, field);
};

template <Declared Type>
struct Form<Type> {
  static void write(const Type& value, JsonText& out) {
    FieldWriter writer(out);
    fields(value, writer);
  }
  static void read(const JsonView& json, Type& value) {
    FieldReader reader(json);
    fields(value, reader);
  }
  static void law(Json& out) {
    Type sample;
    FieldSchema described(out);
    fields(sample, described);
  }
};

// Whole files.

template <class Type>
std::string file_text_of(const Type& value) {
  JsonText out;
  Form<Type>::write(value, out);
  return out.take() + "\n";
}

template <class Type>
Json json_of(const Type& value) {
  return Json::parse(file_text_of(value));
}

// UsageError, which names the origin.
template <class Type>
Type from_text(const std::string& text, const std::string& origin, const std::string& refusal) {
  static thread_local JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    Type value;
    Form<Type>::read(json, value);
    return value;
  } catch (const UsageError& error) {
    throw UsageError(origin + ": " + refusal + ": " + error.what());
  }
}

template <class Type>
Json schema_of(const char* title) {
  Json schema;
  Form<Type>::law(schema);
  schema["$schema"] = "http://json-schema.org/draft-07/schema#";
  schema["title"] = title;
  schema["definitions"]["number"] = {
      {"description", "a number, or the text inf, -inf or nan"},
      {"anyOf", {{{"type", "number"}}, {{"enum", {"inf", "-inf", "nan"}}}}}};
  return schema;
}

// How the types of members stand in JSON.

template <std::integral Type>
struct Form<Type> {
  static void write(Type value, JsonText& out) {
    if constexpr (std::is_same_v<Type, bool>)
      out.raw(value ? "true" : "false");
    else
      out.integer(value);
  }
  static void read(const JsonView& json, Type& value) { json.get_to(value); }
  static void law(Json& out) {
    out["type"] = std::is_same_v<Type, bool> ? "boolean" : "integer";
    if (std::is_same_v<Type, std::uint64_t>) out["minimum"] = 0;
  }
};
template <>
struct Form<std::string> {
  static void write(const std::string& value, JsonText& out) { out.text(value); }
  static void read(const JsonView& json, std::string& value) { json.get_to(value); }
  static void law(Json& out) { out["type"] = "string"; }
};

template <>
struct Form<Real> {
  static void write(Real value, JsonText& out) { out.number(value); }
  static void read(const JsonView& json, Real& value) { value = real_of(json); }
  static void law(Json& out) { out["$ref"] = "#/definitions/number"; }
};

template <class Value>
struct Form<std::vector<Value>> {
  static void write(const auto& values, JsonText& out) {
    out.begin('[');
    for (const Value& value : values) Form<Value>::write(value, out);
    out.end(']');
  }
  static void read(const JsonView& json, std::vector<Value>& values) {
    if constexpr (std::is_same_v<Value, Real>) {
      values = reals_of(json);
    } else if constexpr (requires { json.get_to(values); }) {
      json.get_to(values);
    } else {
      values.clear();
      for (const JsonView& each : json.values()) Form<Value>::read(each, values.emplace_back());
    }
  }
  static void law(Json& out) {
    out["type"] = "array";
    Form<Value>::law(out["items"]);
  }
};

template <class Value, std::size_t count>
struct Form<std::array<Value, count>> {
  static void write(const std::array<Value, count>& values, JsonText& out) {
    Form<std::vector<Value>>::write(values, out);
  }
  static void read(const JsonView& json, std::array<Value, count>& values) {
    std::vector<Value> list;
    Form<std::vector<Value>>::read(json, list);
    require(list.size() == count, "a list has the wrong length");
    std::ranges::copy(list, values.begin());
  }
  static void law(Json& out) {
    Form<std::vector<Value>>::law(out);
    out["minItems"] = out["maxItems"] = count;
  }
};

inline std::string key_text(const std::string& key) { return key; }
inline std::string key_text(std::int64_t key) { return std::to_string(key); }
inline void read_key(const std::string& text, std::string& key) { key = text; }
inline void read_key(const std::string& text, std::int64_t& key) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), key);
  require(error == std::errc() && end == text.data() + text.size(),
          [&] { return "expected an integer, got " + text; });
}

template <class Key, class Value>
struct Form<std::map<Key, Value>> {
  static void write(const std::map<Key, Value>& values, JsonText& out) {
    out.begin('{');
    for (const auto& [key, value] : values) {
      out.key(key_text(key));
      Form<Value>::write(value, out);
    }
    out.end('}');
  }
  static void read(const JsonView& json, std::map<Key, Value>& values) {
    values.clear();
    for (const auto& [text, value] : json.items()) {
      Key key{};
      read_key(text, key);
      Form<Value>::read(value, values[key]);
    }
  }
  static void law(Json& out) {
    out["type"] = "object";
    Form<Value>::law(out["additionalProperties"]);
  }
};

// null if it does not exist.
template <class Value>
struct Form<std::optional<Value>> {
  static void write(const std::optional<Value>& value, JsonText& out) {
    if (value)
      Form<Value>::write(*value, out);
    else
      out.raw("null");
  }
  static void read(const JsonView& json, std::optional<Value>& value) {
    value.reset();
    if (!json.is_null()) Form<Value>::read(json, value.emplace());
  }
  static void law(Json& out) {
    Form<Value>::law(out["anyOf"].emplace_back());
    out["anyOf"].push_back({{"type", "null"}});
  }
};

// By name; older records lack what was counted later.
template <>
struct Form<OracleCounts> {
  static void write(const OracleCounts& counts, JsonText& out) {
    out.begin('{');
    for (std::size_t kind = 0; kind < kOracles; ++kind) {
      out.key(kOracleNames[kind]);
      out.integer(counts[kind]);
    }
    out.end('}');
  }
  static void read(const JsonView& json, OracleCounts& counts) {
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      if (json.contains(kOracleNames[kind])) counts[kind] = json.at(kOracleNames[kind]);
  }
  static void law(Json& out) {
    out = {{"type", "object"}, {"additionalProperties", false}, {"required", Json::array()}};
    for (const OracleRow& oracle : kOracleTable) {
      out["properties"][std::string(oracle.name)] = {{"type", "integer"}, {"minimum", 0}};
      if (oracle.is_in_every_record) out["required"].push_back(oracle.name);
    }
  }
};

template <>
struct Form<OptionValues> {
  static void write(const OptionValues& options, JsonText& out) {
    out.raw(json_text(to_json(options)));
  }
  static void read(const JsonView& json, OptionValues& options) {
    options = option_values_from(json.json());
  }
  static void law(Json& out) { out["type"] = "object"; }
};

template <>
struct Form<Status> {
  static void write(Status status, JsonText& out) { out.text(name_of(status)); }
  static void read(const JsonView& json, Status& status) {
    const auto found = status_of(json.get<std::string>());
    require(found.has_value(), [&] { return "unknown status " + json.get<std::string>(); });
    require(found != Status::running, "it was written before its run ended");
    status = *found;
  }
  static void law(Json& out) {
    for (const std::string_view name : kStatusNames)
      if (name != name_of(Status::running)) out["enum"].push_back(name);  // it is never written
  }
};

template <>
struct Form<Aim> {
  static void write(Aim aim, JsonText& out) { out.text(name_of(aim)); }
  static void read(const JsonView& json, Aim& aim) {
    const auto found = aim_of(json.get<std::string>());
    require(found.has_value(), [&] { return "unknown aim " + json.get<std::string>(); });
    aim = *found;
  }
  static void law(Json& out) { out["enum"] = kAimNames; }
};

// A list of columns.
template <>
struct Form<Grid> {
  static void write(const Grid& grid, JsonText& out) {
    out.begin('[');
    for (Index j = 0; j < grid.columns(); ++j) Form<std::vector<Real>>::write(grid.column(j), out);
    out.end(']');
  }
  static void read(const JsonView& json, Grid& grid) {
    std::vector<Real> values;
    const std::vector<JsonView> columns = json.values();
    std::size_t rows = 0;
    for (const JsonView& column : columns) {
      const std::vector<Real> numbers = reals_of(column);
      if (&column == &columns.front()) rows = numbers.size();
      require(numbers.size() == rows, "the columns of an array differ in length");
      values.insert(values.end(), numbers.begin(), numbers.end());
    }
    grid = Grid(static_cast<Index>(rows), static_cast<Index>(columns.size()), std::move(values));
  }
  static void law(Json& out) { Form<std::vector<std::vector<Real>>>::law(out); }
};

// A number that stands for "no limit" where it is the largest of its type: null.
template <class Value>
struct Unlimited {
  Value& value;
};
template <class Value>
struct Form<Unlimited<Value>> {
  static constexpr auto kNone = std::numeric_limits<std::remove_const_t<Value>>::max();

  static void write(const Unlimited<Value>& limit, JsonText& out) {
    if (limit.value < kNone)
      out.integer(limit.value);
    else
      out.raw("null");
  }
  static void read(const JsonView& json, const Unlimited<Value>& limit) {
    limit.value = kNone;
    if (!json.is_null()) json.get_to(limit.value);
  }
  static void law(Json& out) { out["type"] = {"integer", "null"}; }
};

// A list or an object kept as its text.
template <class Text>
struct JsonAsText {
  Text& text;
};
template <class Text>
struct Form<JsonAsText<Text>> {
  static void write(const JsonAsText<Text>& value, JsonText& out) { out.raw(value.text); }
  static void read(const JsonView& json, const JsonAsText<Text>& value) {
    value.text = json_text(json.json());
  }
  static void law(Json& out) { out = Json::object(); }
};

}  // namespace isoline
