// Writes figures, and escapes foreign text for each format.
#include "reports/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>

namespace isoline::reports {
namespace {

struct Escape {
  char letter;
  std::string_view text;
};

constexpr Escape kHtml[] = {
    {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};

// An @ would notify a stranger on a forge, a # link to some issue.
constexpr Escape kMarkdown[] = {{'&', "&amp;"}, {'<', "&lt;"},  {'>', "&gt;"}, {'@', "&#64;"},
                                {'#', "&#35;"}, {'\\', "\\\\"}, {'|', "\\|"},  {'`', "\\`"},
                                {'*', "\\*"},   {'_', "\\_"},   {'[', "\\["},  {']', "\\]"},
                                {'~', "\\~"},   {'$', "\\$"}};

// A bracket or star after \\ would be its argument.
constexpr Escape kLatex[] = {{'\\', "\\textbackslash{}"},
                             {'^', "\\textasciicircum{}"},
                             {'~', "\\textasciitilde{}"},
                             {'<', "\\textless{}"},
                             {'>', "\\textgreater{}"},
                             {'|', "\\textbar{}"},
                             {'"', "''"},
                             {'[', "{[}"},
                             {']', "{]}"},
                             {'*', "{*}"},
                             {'{', "\\{"},
                             {'}', "\\}"},
                             {'$', "\\$"},
                             {'&', "\\&"},
                             {'#', "\\#"},
                             {'_', "\\_"},
                             {'%', "\\%"}};

// Control characters become blanks: no text from a record breaks a line or a cell.
std::string escaped(std::string_view text, std::span<const Escape> escapes) {
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  for (const char letter : text) {
    const auto at = std::ranges::find(escapes, letter, &Escape::letter);
    const auto byte = static_cast<unsigned char>(letter);
    if (at != escapes.end())
      out += at->text;
    else
      out += byte < ' ' || byte == 127 ? ' ' : letter;
  }
  return out;
}

// "1.2e-05" -> "1.2e-5".
std::string without_idle_zeros(std::string text) {
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  std::size_t digits = e + 2;  // after the sign
  while (digits + 1 < text.size() && text[digits] == '0') text.erase(digits, 1);
  if (text[e + 1] == '+') text.erase(e + 1, 1);
  return text;
}

// Four significant digits, "1.200e-04" without the zeros that say nothing: "1.2e-04".
std::string scientific(Real value) {
  std::string text = fmt::format("{:.3e}", value);
  std::size_t end = text.find('e');
  while (text[end - 1] == '0' || text[end - 1] == '.') {
    const bool was_point = text[end - 1] == '.';
    text.erase(--end, 1);
    if (was_point) break;
  }
  return text;
}

}  // namespace

std::string figure(Real value) {
  constexpr Real kInFull = 1e7;
  if (std::isfinite(value) && std::abs(value) < kInFull && value == std::round(value))
    return fmt::format("{:.0f}", std::abs(value) == 0 ? 0.0 : value);
  constexpr Real kScientificBelow = 1e-3;  // 1.842e-4 is shorter than 0.0001842
  const bool is_tiny = std::abs(value) < kScientificBelow;
  std::string text = fmt::format("{:.4g}", value);
  if (is_tiny && text.find('e') == std::string::npos) text = scientific(value);
  return without_idle_zeros(std::move(text));
}

std::string milliseconds(Real seconds) {
  constexpr Real kWhole = 1000;
  const Real value = 1e3 * seconds;
  if (value == kNever) return "✗";
  return value < kWhole ? without_idle_zeros(fmt::format("{:.3g}", value))
                        : fmt::format("{:.0f}", value);
}

std::string exact_figure(Real value) {
  if (std::isfinite(value) && std::abs(value) < 1e15 && value == std::round(value))
    return fmt::format("{:.0f}", value);
  return without_idle_zeros(fmt::format("{}", value));
}

std::string reached_figure(Real value) { return value == kNever ? "✗" : figure(value); }

std::string range_figure(const Spread& spread, std::string (*written)(Real)) {
  if (spread.n <= 1 || spread.low == spread.high) return "";
  return fmt::format("{}–{}", written(spread.low), written(spread.high));
}

std::string figure(const Spread& spread) {
  if (spread.n == 0) return "";
  const std::string range = range_figure(spread, reached_figure);
  return reached_figure(spread.median) + (range.empty() ? "" : fmt::format(" ({})", range));
}

std::string percent(Real share) { return fmt::format("{:.0f} %", 100 * share); }

std::string shown_spec(std::string_view spec) {
  constexpr std::size_t kLong = 7;  // "0.01389" still stands in full
  std::string out;
  for (std::size_t i = 0; i < spec.size();) {
    const std::size_t end = std::min(spec.find_first_not_of("0123456789.e-", i), spec.size());
    const std::string word(spec.substr(i, end - i));
    const bool is_value = i > 0 && spec[i - 1] == '=';
    char* rest = nullptr;
    const Real value = is_value && word.size() > kLong ? std::strtod(word.c_str(), &rest) : 0;
    out += rest != nullptr && *rest == 0 ? figure(value) : word;
    if (end < spec.size()) out += spec[end];
    i = end + 1;
  }
  return out;
}

std::string html_text(std::string_view text) { return escaped(text, kHtml); }

std::string markdown_text(std::string_view text) { return escaped(text, kMarkdown); }

std::string latex_text(std::string_view text) {
  std::string ascii;  // pdflatex stops at a character that its fonts lack
  for (const char letter : text) {
    const auto byte = static_cast<unsigned char>(letter);
    if (byte < 0x80)
      ascii += letter;
    else if (byte >= 0xC0)
      ascii += '?';
  }
  return escaped(ascii, kLatex);
}

std::string csv_field(std::string_view text) {
  std::string field = escaped(text, {});
  const bool is_formula = !field.empty() && std::string_view("=+-@").find(field[0]) < 4;
  if (is_formula) field.insert(0, 1, '\'');  // a spreadsheet would run it
  if (field.find_first_of(",\"'") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char letter : field) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + '"';
}

std::string terminal_text(std::string_view text) {
  std::string safe(text);
  for (char& letter : safe)
    if (static_cast<unsigned char>(letter) < ' ' || letter == 127) letter = '?';
  return safe;
}

std::string shell_word(std::string_view text) {
  std::string word = "'";
  for (const char letter : text) word += letter == '\'' ? "'\\''" : std::string(1, letter);
  return word + "'";
}

}  // namespace isoline::reports
