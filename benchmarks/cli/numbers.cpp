// Numbers read whole: no sign is dropped, none is cut at the end of its type.
#include "benchmarks/cli/numbers.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/errors.h"
#include "core/spec.h"

namespace isoline::benchmarks {
namespace {

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return value;
}

struct Unit {
  std::string_view name;
  double bytes;
};
constexpr double kKilo = 1024;
constexpr std::array<Unit, 4> kUnits = {{{"k", kKilo},
                                         {"m", kKilo* kKilo},
                                         {"g", kKilo* kKilo* kKilo},
                                         {"t", kKilo* kKilo* kKilo* kKilo}}};

// The unit that the text ends with, which is taken off: "", "b", "g", "gb" or "gib".
double unit_of(std::string& text) {
  for (const std::string_view end : {"ib", "b"})
    if (text.ends_with(end)) {
      text.resize(text.size() - end.size());
      break;
    }
  for (const auto& [name, bytes] : kUnits)
    if (text.ends_with(name)) {
      text.resize(text.size() - name.size());
      return bytes;
    }
  return 1;
}

}  // namespace

std::int64_t read_whole(const std::string& option, const std::string& text, WholeLaw law) {
  const auto value = number_in<std::int64_t>(text);
  require(value && *value >= law.low && *value <= law.high, [&] {
    return fmt::format("{} must be a whole number from {} to {}, got '{}'", option, law.low,
                       count_text(static_cast<std::uint64_t>(law.high)), text);
  });
  return *value;
}

std::uint64_t read_seed(const std::string& option, const std::string& text) {
  const auto value = number_in<std::uint64_t>(text);
  require(value.has_value(), [&] {
    return fmt::format("{} must be a whole number from 0 to {}, got '{}'", option,
                       std::numeric_limits<std::uint64_t>::max(), text);
  });
  return *value;
}

double read_real(const std::string& option, const std::string& text, const Range& range) {
  const auto value = number_in<double>(text);
  require(value && contains(range, *value), [&] {
    return fmt::format("{} must be a number in {}, got '{}'", option, text_of(range), text);
  });
  return *value;
}

double read_time(const std::string& option, const std::string& text) {
  try {
    return parse_duration(text);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", option, error.what()));
  }
}

std::int64_t read_bytes(const std::string& option, const std::string& text) {
  constexpr double kLeast = 16 * kKilo * kKilo, kMost = kKilo * kUnits.back().bytes;
  std::string amount = text;
  for (char& letter : amount)
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  const double unit = unit_of(amount);
  const auto value = number_in<double>(amount);
  const double bytes = value ? *value * unit : -1;
  require(bytes >= kLeast && bytes <= kMost, [&] {
    return fmt::format("{} must be from 16MB to 1024TB, such as 2GB, got '{}'", option, text);
  });
  return static_cast<std::int64_t>(bytes);
}

}  // namespace isoline::benchmarks
