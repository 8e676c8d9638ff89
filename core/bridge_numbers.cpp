// Numbers as texts, be they finite or not.
#include "core/bridge_numbers.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"

namespace isoline {
namespace {

bool is_word(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
}

// What some servers write where a number is not finite, as a text that real_of() reads; empty where
// the word is none of these.
std::string_view named(std::string_view word) {
  if (word == "NaN" || word == "nan") return "\"nan\"";
  if (word == "Infinity" || word == "inf" || word == "Inf") return "\"inf\"";
  if (word == "-Infinity" || word == "-inf" || word == "-Inf") return "\"-inf\"";
  if (word == "-NaN" || word == "-nan") return "\"nan\"";
  return {};
}

// What stands in quotes is left as it is.
std::string with_named_numbers(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    const bool is_minus = letter == '-' && i + 1 < text.size() && is_word(text[i + 1]);
    const bool follows_digit = i > 0 && text[i - 1] >= '0' && text[i - 1] <= '9';  // of 1e5
    if (letter == '"') is_quoted = !is_quoted;
    if (is_quoted || follows_digit || (!is_minus && !is_word(letter))) {
      out += letter;
      if (is_quoted && letter == '\\' && i + 1 < text.size()) out += text[++i];
      continue;
    }
    std::size_t end = i + 1;
    while (end < text.size() && is_word(text[end])) ++end;
    const std::string_view word = text.substr(i, end - i), number = named(word);
    out += number.empty() ? word : number;
    i = end - 1;
  }
  return out;
}

}  // namespace

Json bridge_json(std::string_view text, const std::string& origin) {
  return parse_json(with_named_numbers(text), origin);
}

Numbers numbers_of(const Json& list) {
  require(list.is_array(), "a list of numbers was expected");
  Numbers numbers;
  numbers.reserve(list.size());
  for (const Json& each : list) numbers.push_back(each.is_null() ? std::nan("") : real_of(each));
  return numbers;
}

void append_number(std::string& out, Real value) {
  if (std::isnan(value)) {
    out += "NaN";
    return;
  }
  if (std::isinf(value)) {
    out += value > 0 ? "Infinity" : "-Infinity";
    return;
  }
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  const std::string_view text(digits, static_cast<std::size_t>(end - digits));
  out += text;
  if (text.find_first_of(".e") == std::string_view::npos) out += ".0";  // −0 would lose its sign
}

void append_numbers(std::string& out, const Numbers& values) {
  out += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out += ',';
    append_number(out, values[i]);
  }
  out += ']';
}

void append_vectors(std::string& out, const std::vector<Numbers>& vectors) {
  out += '[';
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (i > 0) out += ',';
    append_numbers(out, vectors[i]);
  }
  out += ']';
}

}  // namespace isoline
