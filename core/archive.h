// State written to bytes and read back by the same line: archive(s.m, s.v, s.power1).
#pragma once

#include <cstring>
#include <string>
#include <type_traits>

#include "core/array.h"
#include "core/errors.h"

namespace isoline {

class Archive {
 public:
  Archive() = default;  // writes
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)), is_reading_(true) {}

  bool is_reading() const { return is_reading_; }
  const std::string& bytes() const { return bytes_; }

  template <class... Values>
  void operator()(Values&... values) {
    (one(values), ...);
  }
  void raw(void* data, std::size_t size) {
    if (size == 0) return;  // an empty array has no address
    if (!is_reading_) {
      bytes_.append(static_cast<const char*>(data), size);
      return;
    }
    require(size <= bytes_.size() - position_, "the archive ends too early");
    std::memcpy(data, bytes_.data() + position_, size);
    position_ += size;
  }

 private:
  template <class Value>
  void one(Value& value) {
    if constexpr (requires { value.resize(value.rows(), value.cols()); }) {
      Index rows = value.rows(), columns = value.cols();
      (*this)(rows, columns);
      if (is_reading_) value.resize(rows, columns);
      raw(value.data(), sizeof(*value.data()) * static_cast<std::size_t>(value.size()));
    } else {
      static_assert(std::is_trivially_copyable_v<Value>);
      raw(&value, sizeof value);
    }
  }

  std::string bytes_;
  std::size_t position_ = 0;
  bool is_reading_ = false;
};

}  // namespace isoline
