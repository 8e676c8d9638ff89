// JSON with numbers that survive.
#include "core/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/errors.h"
#include "core/files.h"

namespace isoline {
namespace {

// Trees are copied, compared and written by recursion: each level takes of the stack.
constexpr std::size_t kMostNesting = 200;

// How deep lists and objects stand within each other, texts aside; of what is no JSON some number.
std::size_t nesting_of(std::string_view text) {
  std::size_t depth = 0, most = 0;
  bool is_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (letter == '"') is_text = !is_text;
    if (is_text && letter == '\\') ++i;
    if (is_text) continue;
    const auto is_one_of = [&](const char(&two)[3]) {
      return letter == two[0] || letter == two[1];
    };
    if (is_one_of("[{")) most = std::max(most, ++depth);
    if (is_one_of("]}") && depth > 0) --depth;
  }
  return most;
}

}  // namespace

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

Json parse_json(const std::string& text, const std::string& origin) {
  require(nesting_of(text) <= kMostNesting, [&] {
    return fmt::format("{} is nested deeper than {} levels, the limit for JSON", origin,
                       kMostNesting);
  });
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {  // also of numbers that are out of range
    throw UsageError(fmt::format("{} is not JSON: {}", origin, error.what()));
  }
}

Json read_json(const std::filesystem::path& path) {
  return parse_json(read_text(path), path.string());
}

void write_json(const std::filesystem::path& path, const Json& value) {
  write_text(path, json_text(value, 1) + "\n");
}

}  // namespace isoline
