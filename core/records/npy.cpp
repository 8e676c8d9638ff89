// NumPy's file format: a magic word, a header in the notation of a Python dictionary, raw numbers.
#include "core/records/npy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>
#include <regex>

#include "core/errors.h"
#include "core/files.h"

namespace isoline {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kPreamble = 8;  // magic, major and minor version
constexpr std::size_t kAlignment = 64;

struct Header {
  std::string type;
  bool is_column_major = false;
  std::vector<Index> shape;
  std::size_t data_begin = 0;
};

std::size_t length_field(const std::string& bytes, std::size_t size) {
  std::size_t length = 0;
  for (std::size_t i = 0; i < size; ++i)
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[kPreamble + i])) << (8 * i);
  return length;
}

Header header_of(const std::string& bytes) {
  require(bytes.starts_with(kMagic) && bytes.size() > kPreamble + 4, "it is no .npy file");
  const std::size_t field = bytes[6] == 1 ? 2 : 4;  // version 1.0 has two bytes of length
  Header header;
  header.data_begin = kPreamble + field + length_field(bytes, field);
  require(header.data_begin <= bytes.size(), "its header is cut short");
  const std::string text(bytes, kPreamble + field, header.data_begin - kPreamble - field);
  static const std::regex type("'descr': *'([^']*)'"), order("'fortran_order': *(True|False)"),
      shape("'shape': *\\(([0-9, ]*)\\)");
  std::smatch found;
  require(std::regex_search(text, found, type), "its header names no plain type of numbers");
  header.type = found[1];
  require(std::regex_search(text, found, order), "its header names no order of indices");
  header.is_column_major = found[1] == "True";
  require(std::regex_search(text, found, shape), "its header names no shape");
  const std::string sizes = found[1];
  static const std::regex number("[0-9]+");
  for (std::sregex_iterator i(sizes.begin(), sizes.end(), number), end; i != end; ++i)
    header.shape.push_back(std::stoll(i->str()));
  return header;
}

template <class Number>
std::vector<Real> numbers_at(const std::string& bytes, std::size_t begin, std::size_t count) {
  require(bytes.size() - begin == count * sizeof(Number), [&] {
    return fmt::format("it holds {} bytes of numbers and its shape asks for {}",
                       bytes.size() - begin, count * sizeof(Number));
  });
  std::vector<Number> raw(count);
  if (count > 0) std::memcpy(raw.data(), bytes.data() + begin, count * sizeof(Number));
  return {raw.begin(), raw.end()};
}

std::vector<Real> numbers_of(const std::string& bytes, const Header& header, std::size_t count) {
  if (header.type == "<f8") return numbers_at<double>(bytes, header.data_begin, count);
  if (header.type == "<f4") return numbers_at<float>(bytes, header.data_begin, count);
  if (header.type == "<i8") return numbers_at<std::int64_t>(bytes, header.data_begin, count);
  if (header.type == "<i4") return numbers_at<std::int32_t>(bytes, header.data_begin, count);
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
    for (std::size_t d = shape.size(); d-- > 0 && ++at[d] == shape[d];) at[d] = 0;
  }
  return out;
}

}  // namespace

NumberArray read_npy(const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  try {
    const Header header = header_of(bytes);
    const Index count =
        std::accumulate(header.shape.begin(), header.shape.end(), Index{1}, std::multiplies<>());
    NumberArray array{header.shape, numbers_of(bytes, header, static_cast<std::size_t>(count))};
    if (header.is_column_major) array.values = turned(array.values, array.shape);
    for (const Real value : array.values)
      require(std::isfinite(value), "it holds a number that is not finite");
    return array;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

void write_npy(const std::filesystem::path& path, const NumberArray& array) {
  const char* comma = array.shape.size() == 1 ? "," : "";
  std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}{}), }}",
                                   fmt::join(array.shape, ", "), comma);
  const std::size_t unpadded = kPreamble + 2 + header.size() + 1;
  header.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ').push_back('\n');
  std::string bytes(kMagic);
  bytes += {'\x01', '\x00', static_cast<char>(header.size() & 0xff),
            static_cast<char>(header.size() >> 8)};
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(array.values.data()),
               array.values.size() * sizeof(Real));
  write_text(path, bytes);
}

}  // namespace isoline
