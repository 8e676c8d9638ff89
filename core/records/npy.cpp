// NumPy's file format: a magic word, a header in the notation of a Python dictionary, raw numbers.
#include "core/records/npy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/errors.h"
#include "core/files.h"
#include "core/numbers.h"
#include "core/text.h"

namespace isoline {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kPreamble = 8;  // magic, major and minor version
constexpr std::size_t kAlignment = 64;
constexpr std::size_t kMostQuoted = 40;           // bytes of a cell
constexpr std::size_t kMostHeaderBytes = 10'000;  // NumPy's own bound (max_header_size)
constexpr std::size_t kMostDimensions = 64;       // NumPy's own bound (NPY_MAXDIMS of NumPy 2)

struct Header {
  std::string type;
  bool is_column_major = false;
  std::vector<Index> shape;
  std::size_t data_begin = 0;
};

// From Python's notation, {'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }, by JSON's: a
// tuple as a list, and without the comma that may follow a last element.
Header header_from(const std::string& text) {
  std::string notation;
  for (const char letter : text) {
    if (letter == ' ' || letter == '\t' || letter == '\r' || letter == '\n') {
      notation += ' ';
      continue;
    }
    const std::size_t last = notation.find_last_not_of(' ');
    const bool closes = letter == ')' || letter == '}';
    const bool is_empty = std::string_view(notation).substr(0, last + 1).ends_with("[,");
    if (closes && last != notation.npos && notation[last] == ',' && !is_empty) notation.erase(last);
    notation += letter == '\'' ? '"' : letter == '(' ? '[' : letter == ')' ? ']' : letter;
  }
  for (const auto& [python, json] : {std::pair("True", "true"), {"False", "false"}})
    if (const auto at = notation.find(python); at != notation.npos)
      notation.replace(at, std::strlen(python), json);
  const auto is_size = [](const Json& size) {
    return size.is_number_unsigned() &&
           size.get<std::uint64_t>() <= std::uint64_t{std::numeric_limits<Index>::max()};
  };
  try {
    const Json header = Json::parse(notation);
    const Json& shape = header.at("shape");
    require(shape.size() <= kMostDimensions,
            [] { return fmt::format("its shape has more than {} indices", kMostDimensions); });
    const bool has_three = header.size() == 3 && std::ranges::count(text, ':') == 3;
    if (has_three && std::ranges::count(text, '[') == 0 && shape.is_array() &&
        std::ranges::all_of(shape, is_size))
      return {.type = header.at("descr").get<std::string>(),
              .is_column_major = header.at("fortran_order").get<bool>(),
              .shape = shape.get<std::vector<Index>>()};
  } catch (const Json::exception&) {
  }
  constexpr std::size_t kShown = 200;
  throw UsageError(fmt::format(
      "its header must have the form {{'descr': '<f8', 'fortran_order': False, 'shape': (3, "
      "4), }}, got {}",
      printable(text.substr(0, kShown))));
}

Header header_of(const std::string& bytes) {
  require(bytes.starts_with(kMagic) && bytes.size() > kPreamble + 4,
          "its content is not that of a .npy file");
  const int version = static_cast<unsigned char>(bytes[kMagic.size()]);
  require(version >= 1 && version <= 3, [&] {
    return fmt::format("its version of the format is {}; 1 to 3 can be read", version);
  });
  const std::size_t field = version == 1 ? 2 : 4;  // bytes of the header's length
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + kPreamble, field);
  require(length <= kMostHeaderBytes, [&] {
    return fmt::format("its header has {} bytes, and at most {} are read", length,
                       kMostHeaderBytes);
  });
  const std::size_t begin = kPreamble + field;
  require(begin + length <= bytes.size(), "its header is incomplete");
  Header header = header_from(bytes.substr(begin, length));
  header.data_begin = begin + length;
  return header;
}

// The number of values in a shape. A size of 0 makes it empty, but excuses no other size.
std::size_t count_of(const std::vector<Index>& shape) {
  Index count = 1, others = 1;
  for (const Index size : shape) {
    require(!__builtin_mul_overflow(others, std::max<Index>(size, 1), &others),
            "its shape needs more numbers than a file can hold");
    count *= size;
  }
  return static_cast<std::size_t>(count);
}

template <class Number>
std::vector<Real> numbers_at(const std::string& bytes, const Header& header) {
  const std::size_t count = count_of(header.shape), present = bytes.size() - header.data_begin;
  require(present % sizeof(Number) == 0 && present / sizeof(Number) == count, [&] {
    return fmt::format(
        "it contains {} bytes of numbers, but its shape requires {} numbers of {} bytes", present,
        count, sizeof(Number));
  });
  std::vector<Real> numbers(count);
  for (std::size_t i = 0; i < count; ++i) {
    Number number;
    std::memcpy(&number, bytes.data() + header.data_begin + i * sizeof(Number), sizeof(Number));
    numbers[i] = static_cast<Real>(number);
  }
  return numbers;
}

std::vector<Real> numbers_of(const std::string& bytes, const Header& header) {
  if (header.type == "<f8") return numbers_at<double>(bytes, header);
  if (header.type == "<f4") return numbers_at<float>(bytes, header);
  if (header.type == "<i8") return numbers_at<std::int64_t>(bytes, header);
  if (header.type == "<i4") return numbers_at<std::int32_t>(bytes, header);
  throw UsageError(
      fmt::format("its numbers are of type '{}'; float64, float32, int64 and int32 "
                  "(little-endian) can be read",
                  header.type));
}

// Column-major numbers as row-major ones.
std::vector<Real> turned(const std::vector<Real>& values, const std::vector<Index>& shape) {
  std::vector<Real> out(values.size());
  std::vector<Index> at(shape.size(), 0);
  for (Real& value : out) {
    Index from = 0;
    for (std::size_t d = shape.size(); d-- > 0;) from = from * shape[d] + at[d];
    value = values[static_cast<std::size_t>(from)];
    for (std::size_t d = shape.size(); d-- > 0;) {
      if (++at[d] < shape[d]) break;
      at[d] = 0;
    }
  }
  return out;
}

template <class Number>
std::string bytes_of(const char* type, const std::vector<Index>& shape,
                     const std::vector<Number>& values) {
  const char* comma = shape.size() == 1 ? "," : "";
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}{}), }}",
                                   type, fmt::join(shape, ", "), comma);
  const std::size_t unpadded = kPreamble + 2 + header.size() + 1;
  header.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ').push_back('\n');
  std::string bytes(kMagic);
  bytes += {'\x01', '\x00', static_cast<char>(header.size() & 0xff),
            static_cast<char>(header.size() >> 8)};
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number));
  return bytes;
}

NumberArray read_csv(const std::filesystem::path& path) {
  const std::string text = read_text(path);
  NumberArray array;
  Index rows = 0, columns = 0, number = 0, first = 0;
  std::string heading;  // the first line, where it holds no number
  for (std::string_view rest = without_byte_order_mark(text); !rest.empty();) {
    ++number;
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::vector<std::string_view> cells = cells_of_line(line);
    if (std::ranges::all_of(cells, [](const auto& cell) { return bare_cell(cell).empty(); }) ||
        bare_cell(line).starts_with('#'))
      continue;
    if (first == 0) {
      first = number;
      if (std::ranges::none_of(cells, begins_as_number) &&
          std::ranges::none_of(cells,
                               [](const auto& cell) { return number_in(cell).has_value(); })) {
        heading = bare_cell(line);
        continue;
      }
    }
    const auto count = static_cast<Index>(cells.size());
    if (rows == 0) columns = count;
    require(count == columns, [&] {
      return fmt::format("{}: line {} has {} numbers, the first has {}", path.string(), number,
                         count, columns);
    });
    for (const std::string_view cell : cells) {
      const std::optional<Real> value = number_in(cell);
      require(value && std::isfinite(*value), [&] {
        return fmt::format(
            "{}: line {}: '{}' is not a finite number, such as -1.5e-3; the decimal separator is a "
            "point",
            path.string(), number, cut(cell, kMostQuoted));
      });
      array.values.push_back(*value);
    }
    ++rows;
  }
  require(rows > 0, [&] {
    return heading.empty()
               ? fmt::format("{}: it has no line of numbers", path.string())
               : fmt::format("{}: it has no line of numbers below the heading '{}' of line {}",
                             path.string(), cut(heading, kMostQuoted), first);
  });
  array.shape = {rows, columns};
  return array;
}

void write_csv(const std::filesystem::path& path, const NumberArray& array) {
  const std::size_t rows = static_cast<std::size_t>(array.shape.at(0));
  const std::size_t columns = rows > 0 ? array.values.size() / rows : 0;
  std::string text;
  for (std::size_t row = 0; row < rows; ++row) {
    const auto first = array.values.begin() + static_cast<std::ptrdiff_t>(row * columns);
    text +=
        fmt::format("{}\n", fmt::join(first, first + static_cast<std::ptrdiff_t>(columns), ","));
  }
  write_text(path, text);
}

void require_ending(const std::filesystem::path& path, const std::vector<std::string>& known) {
  require(std::ranges::find(known, path.extension().string()) != known.end(), [&] {
    return fmt::format("{}: the name of a data file must end with {}", path.string(),
                       fmt::join(known, " or "));
  });
}

}  // namespace

NumberArray npy_from_bytes(const std::string& bytes) {
  const Header header = header_of(bytes);
  NumberArray array{header.shape, numbers_of(bytes, header)};
  if (header.is_column_major) array.values = turned(array.values, array.shape);
  for (const Real value : array.values)
    require(std::isfinite(value), "it contains a number that is not finite");
  return array;
}

NumberArray read_npy(const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  try {
    return npy_from_bytes(bytes);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

std::string npy_bytes(const std::vector<Index>& shape, const std::vector<float>& values) {
  return bytes_of("<f4", shape, values);
}

std::string npy_bytes(const NumberArray& array) {
  return bytes_of("<f8", array.shape, array.values);
}

NumberArray read_npy_beside(const std::filesystem::path& path, const std::string& digest_of_file,
                            const std::vector<Index>& shape) {
  const std::string bytes = read_text(path);
  require(digest(bytes) == digest_of_file,
          [&] { return fmt::format("{} is not the file that its record names", path.string()); });
  try {
    NumberArray array = npy_from_bytes(bytes);
    require(array.shape == shape, "its shape differs from the one in its record");
    return array;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

void write_npy(const std::filesystem::path& path, const NumberArray& array) {
  write_text(path, npy_bytes(array));
}

// Numbers as text, and the choice of the format by the file's ending.

NumberArray read_numbers(const std::filesystem::path& path) {
  require_ending(path, {".npy", ".csv", ".txt", ".dat"});
  return path.extension() == ".npy" ? read_npy(path) : read_csv(path);
}

void write_numbers(const std::filesystem::path& path, const NumberArray& array) {
  require_ending(path, {".npy", ".csv"});
  path.extension() == ".npy" ? write_npy(path, array) : write_csv(path, array);
}

}  // namespace isoline
