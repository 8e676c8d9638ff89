// A value that many subjects have alike, kept once: results come by the hundred thousand, and their
// options, the parts of their builds and the names of their figures by the hundred.
#pragma once

#include <concepts>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/options.h"

namespace isoline::reports {

// What tells two values apart.
inline std::string key_of(const std::string& text) { return text; }
std::string key_of(const OptionValues& options);
std::string key_of(const std::map<std::string, std::string>& texts);

// Read as the value itself. It lives as long as the program.
template <class Value>
class Shared {
 public:
  Shared() : Shared(Value()) {}
  template <std::convertible_to<Value> Given>
  requires(!std::same_as<std::remove_cvref_t<Given>, Shared>) Shared(Given&& given)
      : value_(pooled(Value(std::forward<Given>(given)))) {}

  operator const Value&() const { return *value_; }
  const Value& operator*() const { return *value_; }
  const Value* operator->() const { return value_; }
  friend bool operator==(const Shared& a, const Shared& b) { return a.value_ == b.value_; }

 private:
  static const Value* pooled(Value&& value) {
    static std::mutex mutex;
    static std::unordered_map<std::string, Value> pool;
    std::string key = key_of(value);
    const std::lock_guard lock(mutex);
    return &pool.try_emplace(std::move(key), std::move(value)).first->second;
  }

  const Value* value_;
};

}  // namespace isoline::reports
