// Functions that several formats share: they escape foreign text, and divide wide tables.
#include <algorithm>
#include <span>

#include "core/text.h"
#include "reports/formats/formats.h"

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

}  // namespace

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

std::string exact_csv_field(std::string_view text) {
  if (text.find_first_of(",\"'\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + '"';
}

std::string csv_field(std::string_view text) {
  const std::string field = escaped(printable(text), {});
  const bool is_formula = !field.empty() && std::string_view("=+-@").find(field[0]) < 4;
  return exact_csv_field(is_formula ? "'" + field : field);
}

std::string terminal_text(std::string_view text) {
  std::string safe(text);
  for (char& letter : safe)
    if (letter == '\n' || letter == '\t')  // of messages in several lines
      letter = ' ';
    else if (static_cast<unsigned char>(letter) < ' ' || letter == 127)
      letter = '?';
  return safe;
}

std::vector<Part> table_parts(const Table& table, std::size_t most) {
  std::vector<Part> parts;
  std::size_t at = table.names;
  const auto take = [&](std::size_t count) {
    Part& part = parts.emplace_back();
    for (std::size_t i = 0; i < table.names; ++i) part.push_back(i);
    for (; count > 0 && at < table.columns.size(); --count) part.push_back(at++);
  };
  for (const std::size_t count : table.parts) take(count);
  // As many a part as divides them evenly: 20 columns are 7, 7 and 6.
  const std::size_t rest = table.columns.size() - at, pieces = (rest + most - 1) / most;
  while (at < table.columns.size()) take((rest + pieces - 1) / pieces);
  return parts;
}

}  // namespace isoline::reports
