// Text that fits the width of a terminal.
#include "core/columns.h"

#include <sys/ioctl.h>

#include <algorithm>

namespace isoline {
namespace {

// Bytes that continue a character of UTF-8 take no column.
bool is_first_byte(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }

bool is_verbatim(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  for (const char* start : {"./isoline ", "isoline ", "python3 ", "cd ", "|", "{", "[", "\""})
    if (line.starts_with(start)) return true;
  return false;
}

// The column at which the line goes on: after the last two spaces that leave room for words.
std::size_t hanging_column(std::string_view line, std::size_t columns) {
  constexpr std::size_t kRoom = 20;
  std::size_t column = 0, spaces = 2, found = 0;
  for (const char byte : line) {
    if (byte != ' ' && spaces >= 2 && column + kRoom <= columns) found = column;
    spaces = byte == ' ' ? spaces + 1 : 0;
    column += is_first_byte(byte);
  }
  return found;
}

std::string fitted_line(std::string line, std::size_t columns) {
  const auto width = std::ranges::count_if(line, is_first_byte);
  if (static_cast<std::size_t>(width) <= columns || is_verbatim(line)) return line;
  const std::size_t hanging = hanging_column(line, columns);
  std::string out;
  while (true) {
    std::size_t column = 0, space = line.npos;
    bool is_quoted = false;
    for (std::size_t at = 0; at < line.size() && (column <= columns || space == line.npos); ++at) {
      if (line[at] == '`') is_quoted = !is_quoted;
      if (line[at] == ' ' && !is_quoted && column > hanging) space = at;
      column += is_first_byte(line[at]);
    }
    if (column <= columns || space == line.npos) return out + line;
    const std::size_t next = line.find_first_not_of(' ', space);
    out += line.substr(0, line.find_last_not_of(' ', space) + 1) + '\n';
    if (next == line.npos) return out;
    line = std::string(hanging, ' ') + line.substr(next);
  }
}

}  // namespace

std::size_t terminal_width(int descriptor) {
  constexpr std::size_t kUsual = 80;
  winsize size{};
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsual;
}

std::string fitted_text(std::string_view text, std::size_t columns) {
  std::string out;
  for (std::size_t end = 0; end != text.npos; text.remove_prefix(end + 1)) {
    end = text.find('\n');
    out += fitted_line(std::string(text.substr(0, end)), columns);
    if (end == text.npos) break;
    out += '\n';
  }
  return out;
}

}  // namespace isoline
