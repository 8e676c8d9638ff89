// JSON as text: views of it, and schemas. The large headers of the libraries stay in json_view.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/real.h"

namespace isoline {

using Json = nlohmann::json;

// JSON for a single pass: values in parsed text, some eight times as fast as a tree, for records by
// the hundred thousand. With json_view.cpp the only adapter to simdjson. A value that is missing or
// of another type is a UsageError.

// Types that a view's get_to() reads. A separate name: within the class its members are not known
// yet.
template <class Value, class View>
concept ReadBy = requires(const View& view, Value& out) {
  view.get_to(out);
};

// Valid until its reader parses the next text. Reads as `const nlohmann::json&` would. Two words,
// which json_view.cpp alone knows to be simdjson's place on its tape: its header is large.
class JsonView {
 public:
  struct Place {
    const void* document;
    std::size_t index;
  };
  explicit JsonView(Place place) : place_(place) {}

  JsonView at(std::string_view key) const;
  JsonView operator[](std::string_view key) const { return at(key); }
  bool contains(std::string_view key) const;
  bool is_null() const;
  std::vector<JsonView> values() const;                         // of an array
  std::vector<std::pair<std::string, JsonView>> items() const;  // of an object
  std::string text() const;                                     // as JSON, without spaces
  nlohmann::json json() const;                                  // a copy that stays

  void get_to(bool& out) const;
  void get_to(int& out) const;
  void get_to(std::int64_t& out) const;
  void get_to(std::uint64_t& out) const;
  void get_to(std::string& out) const;
  void get_to(std::vector<std::int64_t>& out) const;
  void get_to(std::vector<std::string>& out) const;

  template <class Value>
  Value get() const {
    Value value;
    get_to(value);
    return value;
  }
  template <ReadBy<JsonView> Value>
  operator Value() const {
    return get<Value>();
  }

 private:
  Place place_;

  friend Real real_of(const JsonView& value);
  friend std::vector<Real> reals_of(const JsonView& list);
};

// The reason of an exception; in our words where it is one of a library.
std::string reason_of(const std::exception& error);
// The same without the name of the file, where it begins with it.
std::string reason_without(const std::string& file, const std::exception& error);

std::string json_of_text(const std::string& text);  // a text as JSON, quoted

Real real_of(const JsonView& value);  // also "inf", "-inf" and "nan"
std::vector<Real> reals_of(const JsonView& list);

// Uses the same buffers for all texts, so use one object per thread. The parser stays in
// json_view.cpp, because its layout depends on the compilation with threads.
class JsonReader {
 public:
  JsonReader();
  ~JsonReader();
  JsonView parse(const std::string& text, const std::string& origin);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

// JSON Schema, read once, for documents by the hundred thousand.
class Schema {
 public:
  explicit Schema(const Json& schema);
  ~Schema();

  // The errors in the document, one sentence each, beginning with the place; empty if it conforms.
  std::vector<std::string> violations(const Json& document) const;

 private:
  struct Parsed;
  std::unique_ptr<const Parsed> parsed_;
};

std::vector<std::string> schema_violations(const Json& document, const Json& schema);

// A JSON text in the form in which single values are checked: a tree with shortened columns. A long
// list of numbers and texts is reduced to its least and greatest integer, its least and greatest
// other number, and each of its texts once. Constraints on the type, the range or the choices of an
// element hold for these if and only if they hold for all. UsageError names the origin if it is not
// JSON.
Json outline_of(const std::string& text, const std::string& origin);

}  // namespace isoline
