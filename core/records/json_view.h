// JSON to write and to read: places in a tree, and views of a text. The headers of the libraries,
// which are large, stay in json_view.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/real.h"

namespace isoline {

using Json = nlohmann::json;

// Valid as long as its tree, and until its list grows.
class JsonPlace {
 public:
  explicit JsonPlace(Json& here) : here_(&here) {}

  JsonPlace operator[](std::string_view member) const;  // made where it is missing
  JsonPlace next() const;                               // a new element at the end of the list
  void make_object() const;                             // an empty one
  void make_list() const;                               // an empty one
  void set_null() const;
  void set(bool value) const;
  void set(std::int64_t value) const;
  void set(std::uint64_t value) const;
  void set(std::string_view value) const;  // of what is no UTF-8 U+FFFD stays
  void set(const char* value) const { set(std::string_view(value)); }
  void set(Real value) const;                    // also infinite, or not a number
  void set(std::span<const Real> values) const;  // a list of them
  void set(Json value) const;

  void parse(std::string_view text) const;  // JSON as text
  void include(
      std::string_view text) const;  // the members of an object as text, put beside its own
  // A further constraint of a schema. A constraint that refers to a definition is complete in
  // itself.
  void restrict(std::string_view law) const;

 private:
  Json* here_;
};

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
  std::string tree_text() const;                                // as a tree of it writes itself
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

std::string json_of_text(const std::string& text);  // a text as JSON, quoted

Real real_of(const JsonView& value);  // also "inf", "-inf" and "nan"
std::vector<Real> reals_of(const JsonView& list);

// Reuses its buffers for all texts: one object per thread. The parser stays in json_view.cpp, since
// its layout depends on whether a file is compiled with threads.
class JsonReader {
 public:
  JsonReader();
  ~JsonReader();
  JsonView parse(const std::string& text, const std::string& origin);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace isoline
