// JSON that preserves infinite numbers and NaN.
#include "core/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "core/errors.h"
#include "core/files.h"

namespace isoline {
Json json_number(Real value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json json_numbers(std::span<const Real> values) {
  Json list = Json::array();
  for (const Real value : values) list.push_back(json_number(value));
  return list;
}

Real real_of(const Json& value) {
  if (value.is_number()) return value.get<Real>();
  const std::string text = value.is_string() ? value.get<std::string>() : "";
  if (text == "nan") return std::nan("");
  if (text == "inf") return std::numeric_limits<Real>::infinity();
  if (text == "-inf") return -std::numeric_limits<Real>::infinity();
  throw UsageError(fmt::format("expected a number, got {}", json_text(value)));
}

std::vector<Real> reals_of(const Json& list) {
  std::vector<Real> values;
  values.reserve(list.size());
  for (const Json& value : list) values.push_back(real_of(value));
  return values;
}

std::string json_text(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// In place of the library's own words: where it stopped, and at which character.
static std::string place_of_error(const std::string& text, std::size_t byte) {
  if (byte > text.size()) return "it ends too early";
  const std::size_t at = std::max<std::size_t>(byte, 1) - 1;
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const std::size_t begin = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t column = begin == std::string::npos ? at + 1 : at - begin;
  const auto found = static_cast<unsigned char>(text[at]);
  const std::string shown = std::isprint(found) != 0 ? fmt::format("'{}'", text[at])
                                                     : fmt::format("the byte 0x{:02x}", found);
  return fmt::format("unexpected {} in line {}, column {}", shown, line, column);
}

Json parse_json(const std::string& text, const std::string& origin) {
  // Trees are copied, compared and written by recursion: each level takes of the stack.
  constexpr int kMostNesting = 200;
  std::vector<std::set<std::string>> names;  // of the objects that are open
  const auto is_kept = [&](int depth, Json::parse_event_t event, const Json& parsed) {
    require(depth <= kMostNesting, [&] {
      return fmt::format("{} is nested deeper than {} levels, the limit for JSON", origin,
                         kMostNesting);
    });
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    // Readers differ in which of the two they take.
    require(event != Json::parse_event_t::key || names.back().insert(parsed).second, [&] {
      return fmt::format("{} has two members {} in one object", origin, json_text(parsed));
    });
    return true;
  };
  // The library would quote a byte of a binary file. 0xEF begins a byte order mark.
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  require(first != std::string::npos, [&] { return origin + " is empty, not JSON"; });
  const auto byte = static_cast<unsigned char>(text[first]);
  require(std::isprint(byte) != 0 || byte == 0xEF, [&] { return origin + " is binary, not JSON"; });
  try {
    return Json::parse(text, is_kept);
  } catch (const Json::parse_error& error) {
    throw UsageError(fmt::format("{} is not JSON: {}", origin, place_of_error(text, error.byte)));
  } catch (const Json::exception&) {
    throw UsageError(origin + " is not JSON: it has a number that a double cannot hold");
  }
}

Json read_json(const std::filesystem::path& path) {
  return parse_json(read_text(path), path.string());
}

void write_json(const std::filesystem::path& path, const Json& value) {
  write_text(path, json_text(value, 1) + "\n");
}

}  // namespace isoline
