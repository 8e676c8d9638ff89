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
  std::size_t bytes_left() const { return bytes_.size() - position_; }  // to be read

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
    require(size <= bytes_left(), kTooShort);
    std::memcpy(data, bytes_.data() + position_, size);
    position_ += size;
  }

 private:
  static constexpr const char* kTooShort = "the archive ends too early";

  // Nothing is allocated for numbers that are not there.
  void require_room(Index rows, Index columns, std::size_t size) const {
    const auto most = static_cast<Index>(bytes_left() / size);
    require(rows >= 0 && columns >= 0 && (rows == 0 || columns <= most / rows), kTooShort);
  }

  template <class Value>
  void one(Value& value) {
    if constexpr (requires { value.resize(value.rows(), value.cols()); }) {
      constexpr Index kColumns = Value::ColsAtCompileTime, kRows = Value::RowsAtCompileTime;
      Index rows = value.rows(), columns = value.cols();
      (*this)(rows, columns);
      if (is_reading_) {
        require_room(rows, columns, sizeof(*value.data()));
        require((kRows < 0 || rows == kRows) && (kColumns < 0 || columns == kColumns),
                "the archive holds an array of another shape");
        value.resize(rows, columns);
      }
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
