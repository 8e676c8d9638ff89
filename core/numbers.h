// Numbers in text files, for all their readers: an optional sign, a decimal point, an
// exponent by e or Fortran's d, in quotation marks or not.
#pragma once

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/real.h"

namespace isoline {

// The mark that a spreadsheet or a Windows editor puts before the first line is left out.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

// Without blanks around it, and without quotation marks around the rest.
inline std::string_view bare_cell(std::string_view cell) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const auto trim = [&] {
    const std::size_t first = cell.find_first_not_of(kBlanks);
    if (first == cell.npos) return cell = {};
    return cell = cell.substr(first, cell.find_last_not_of(kBlanks) + 1 - first);
  };
  trim();
  for (const char quote : {'"', '\''})
    if (cell.size() >= 2 && cell.front() == quote && cell.back() == quote) {
      cell = cell.substr(1, cell.size() - 2);
      trim();
    }
  return cell;
}

// Nothing where the text is not a number as a whole. "inf" and "nan" are numbers.
inline std::optional<Real> number_in(std::string_view cell) {
  std::string text(bare_cell(cell));
  if (text.starts_with('+') && !text.starts_with("+-")) text.erase(0, 1);
  for (std::size_t i = 1; i + 1 < text.size(); ++i)  // 1.5D+03; no "d" of a word
    if ((text[i] == 'd' || text[i] == 'D') &&
        (text[i - 1] == '.' || (text[i - 1] >= '0' && text[i - 1] <= '9')))
      text[i] = 'e';
  Real value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

// Whether it was meant as a number, such as "1,5" or "0.5x", which a heading is not.
inline bool begins_as_number(std::string_view cell) {
  cell = bare_cell(cell);
  if (!cell.empty() && (cell[0] == '+' || cell[0] == '-')) cell.remove_prefix(1);
  if (!cell.empty() && cell[0] == '.') cell.remove_prefix(1);
  return !cell.empty() && cell[0] >= '0' && cell[0] <= '9';
}

// The cells of a line: at semicolons if it has one, else at commas, else at blanks.
inline std::vector<std::string_view> cells_of_line(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<std::string_view> cells;
  const char by = line.find(';') != line.npos ? ';' : line.find(',') != line.npos ? ',' : ' ';
  if (by == ' ') {
    for (std::size_t at = line.find_first_not_of(kBlanks); at != line.npos;) {
      const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
      cells.push_back(line.substr(at, end - at));
      at = line.find_first_not_of(kBlanks, end);
    }
    return cells;
  }
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = std::min(line.find(by, at), line.size());
    cells.push_back(bare_cell(line.substr(at, end - at)));
    at = end + 1;
  }
  return cells;
}

}  // namespace isoline
