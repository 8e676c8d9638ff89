// Options are plain structs with defaults; one visitor names their members, for every use:
//
//   struct Adam { Real rate = 1e-3; };
//   void fields(Adam& o, auto& field) { field("rate", o.rate, above(0), "step length η"); }
//
// Parsing, validation, `describe`, JSON, report columns and sweeps all come from it.
#pragma once

#include <array>
#include <initializer_list>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/errors.h"
#include "core/real.h"

namespace isoline {

struct Range {
  Real low = -std::numeric_limits<Real>::infinity();
  Real high = std::numeric_limits<Real>::infinity();
  bool low_is_open = false, high_is_open = false;
  bool operator==(const Range&) const = default;
};
inline Range any() { return {}; }
inline Range above(Real low) { return {.low = low, .low_is_open = true}; }
inline Range at_least(Real low) { return {.low = low}; }
inline Range between(Real low, Real high) { return {.low = low, .high = high}; }
// The decay of a running mean. At 1 it would ignore new values, and its bias correction would be
// 0/0.
inline Range decay() { return {.low = 0, .high = 1, .high_is_open = true}; }
bool contains(const Range& range, Real value);
std::string range_text(const Range& range);  // "[1, 1000]", "(0, inf)"

using Choices = std::vector<std::string>;  // empty: any text

using OptionValue = std::variant<Real, Index, bool, std::string>;
std::string option_text(const OptionValue& value);  // as in a spec: "0.001", "3", "true", "code"

struct NamedOption {
  std::string name;
  OptionValue value;
  bool operator==(const NamedOption&) const = default;
};

// Values by name, ordered by name: equal lists stand for equal options.
class OptionValues {
 public:
  OptionValues() = default;
  OptionValues(std::initializer_list<NamedOption> values) {
    for (const NamedOption& each : values) set(each.name, each.value);
  }

  void set(std::string_view name, OptionValue value);    // added, or put in place of the old
  void set_all(const OptionValues& others);              // each of them
  void erase(std::string_view name);                     // where there is one
  const OptionValue* find(std::string_view name) const;  // or nullptr
  const OptionValue& at(std::string_view name) const;    // UsageError if it does not exist
  bool contains(std::string_view name) const { return find(name) != nullptr; }
  // As a number, or as text; the fallback if the option is missing or has another type.
  Real number(std::string_view name, Real otherwise) const;
  std::string text(std::string_view name, std::string_view otherwise = "") const;

  bool empty() const { return values_.empty(); }
  std::size_t size() const { return values_.size(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  bool operator==(const OptionValues&) const = default;

 private:
  std::vector<NamedOption> values_;
};

struct OptionField {
  std::string name;
  OptionValue standard;  // the default; its alternative is the field's type
  Range range;
  Choices choices;
  std::string doc;
  bool operator==(const OptionField&) const = default;
};
using OptionTable = std::vector<OptionField>;

// The declared name of an option: `lr` is an alias of `rate`, and `way`, an earlier
// name, of `factorization`.
std::string_view option_name(std::string_view given);

// Every field of the table, defaults filled in, each of its field's type. `component` opens the
// error message. Numbers may come as text, as from a command line.
OptionValues complete_options(const OptionTable& table, const std::string& component,
                              const OptionValues& given);

// "name[key=value,…]" with the values that differ from the defaults.
std::string short_spec(const OptionTable& table, const std::string& name,
                       const OptionValues& options);

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

// Assigns the members of an options struct from complete values.
class OptionReader {
 public:
  explicit OptionReader(const OptionValues& complete) : values_(complete) {}
  void operator()(const char* name, Real& value, const Range&, const char*) { read(name, value); }
  void operator()(const char* name, Index& value, const Range&, const char*) { read(name, value); }
  void operator()(const char* name, bool& value, const char*) { read(name, value); }
  void operator()(const char* name, std::string& value, const Choices&, const char*) {
    read(name, value);
  }

 private:
  template <class Value>
  void read(const char* name, Value& value) const {
    const Value* complete = std::get_if<Value>(&values_.at(name));
    require(complete != nullptr, [&] { return std::string(name) + ": wrong type for the option"; });
    value = *complete;
  }

  const OptionValues& values_;
};

template <class Options>
OptionTable option_table() {
  Options standard;
  OptionLister lister;
  fields(standard, lister);
  return lister.table();
}

template <class Options>
Options read_options(const OptionValues& complete) {
  Options options;
  OptionReader reader(complete);
  fields(options, reader);
  return options;
}

struct NoOptions {};
inline void fields(NoOptions&, auto&) {}

using Json = nlohmann::json;

Json to_json(const OptionValues& options);          // an object; numbers survive
OptionValues option_values_from(const Json& json);  // UsageError if a value has an unknown type
// Without the options that are empty. Only these name a cell, so a component can gain an option
// that is empty by default without renaming its cells.
OptionValues without_empty(const OptionValues& options);
Json describe_options(const OptionTable& table);  // a list of name, type, default, constraint, doc

// Options of every direct problem, which only cells that have them show: files of numbers in the
// place of its start and its target. Completion adds "@" and a digest of the content.
inline constexpr const char *kStartOption = "start-file", *kTargetOption = "target-file";

// Options by which a network learns a problem. Problems declare them (problems/learning.h); plans,
// records and reports read them.

inline constexpr const char *kModeOption = "mode", *kDirectMode = "direct", *kLearnMode = "learn";
inline constexpr const char *kNetworkOption = "network", *kBatchOption = "batch",
                            *kDataOption = "data", *kEpochOption = "epoch", *kWatchOption = "watch";
inline constexpr std::array kLearningOptions = {kModeOption, kNetworkOption, kBatchOption,
                                                kDataOption, kEpochOption,   kWatchOption};

}  // namespace isoline
