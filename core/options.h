// Options are plain structs with defaults; one visitor names their members, for every use:
//
//   struct Adam { Real rate = 1e-3; };
//   void fields(Adam& o, auto& field) { field("rate", o.rate, above(0), "step length η"); }
//
// Parsing, validation, `describe`, JSON, report columns and sweeps all come from it.
#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

#include "core/array.h"
#include "core/errors.h"

namespace isoline {

using Json = nlohmann::json;

struct Range {
  Real low = -std::numeric_limits<Real>::infinity();
  Real high = std::numeric_limits<Real>::infinity();
  bool low_is_open = false;
};
inline Range any() { return {}; }
inline Range above(Real low) { return {.low = low, .low_is_open = true}; }
inline Range at_least(Real low) { return {.low = low}; }
inline Range between(Real low, Real high) { return {.low = low, .high = high}; }
bool contains(const Range& range, Real value);
std::string text_of(const Range& range);  // "[1, 1000]", "(0, inf)"

using Choices = std::vector<std::string>;  // empty: any text

using OptionValue = std::variant<Real, Index, bool, std::string>;

struct OptionField {
  std::string name;
  OptionValue standard;  // the default; its alternative is the field's type
  Range range;
  Choices choices;
  std::string doc;
};
using OptionTable = std::vector<OptionField>;

// Values by name, complete: every field of the table, defaults filled in, in canonical types.
// `component` opens the error message. Numbers may come as text, as from a command line; `lr` is
// an alias of `rate`.
Json complete_options(const OptionTable& table, const std::string& component, const Json& given);

Json describe_options(const OptionTable& table);

// "name[key=value,…]" with the values that differ from the defaults.
std::string short_spec(const OptionTable& table, const std::string& name, const Json& options);

// Lists the fields of an options struct.
class OptionLister {
 public:
  void operator()(const char* name, Real value, const Range& range, const char* doc) {
    table_.push_back({name, value, range, {}, doc});
  }
  void operator()(const char* name, Index value, const Range& range, const char* doc) {
    table_.push_back({name, value, range, {}, doc});
  }
  void operator()(const char* name, bool value, const char* doc) {
    table_.push_back({name, value, {}, {}, doc});
  }
  void operator()(const char* name, const std::string& value, const Choices& choices,
                  const char* doc) {
    table_.push_back({name, value, {}, choices, doc});
  }
  const OptionTable& table() const { return table_; }

 private:
  OptionTable table_;
};

// Assigns the members of an options struct from complete JSON.
class OptionReader {
 public:
  explicit OptionReader(const Json& complete) : json_(complete) {}
  void operator()(const char* name, Real& value, const Range&, const char*);
  void operator()(const char* name, Index& value, const Range&, const char*);
  void operator()(const char* name, bool& value, const char*);
  void operator()(const char* name, std::string& value, const Choices&, const char*);

 private:
  const Json& json_;
};

template <class Options>
OptionTable option_table() {
  Options standard;
  OptionLister lister;
  fields(standard, lister);
  return lister.table();
}

template <class Options>
Options read_options(const Json& complete) {
  Options options;
  OptionReader reader(complete);
  fields(options, reader);
  return options;
}

struct NoOptions {};
inline void fields(NoOptions&, auto&) {}

}  // namespace isoline
