// JSON to write: a place in a tree, which is filled or given members and elements. What JsonView is
// to reading; the tree's own header, which is large, stays in json_place.cpp.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

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
  // A further law of a schema. One that refers to a definition stands alone, so both are asked for.
  void restrict(std::string_view law) const;

 private:
  Json* here_;
};

}  // namespace isoline
