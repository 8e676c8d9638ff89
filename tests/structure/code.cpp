// A reader of C++ that knows just enough: quotes, comments, brackets and clang-format's layout.
#include "tests/structure/code.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <regex>

namespace isoline {
namespace {

std::size_t end_of_raw_string(const std::string& text, std::size_t begin) {
  const std::size_t open = text.find('(', begin);
  const std::string closing = ")" + text.substr(begin + 2, open - begin - 2) + "\"";
  return text.find(closing, open) + closing.size();
}

std::size_t end_of_quote(const std::string& text, std::size_t begin) {
  std::size_t at = begin + 1;
  while (at < text.size() && text[at] != text[begin]) at += text[at] == '\\' ? 2 : 1;
  return at + 1;
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Where what begins here and is no code ends; nothing where code stands here.
std::optional<std::size_t> end_of_noncode(const std::string& text, std::size_t at) {
  const bool is_after_word = at > 0 && is_word(text[at - 1]);
  const bool starts_line = at == 0 || text[at - 1] == '\n';
  if (text.compare(at, 2, "//") == 0 || (starts_line && text[at] == '#'))
    return text.find('\n', at);
  if (text.compare(at, 2, "/*") == 0) return text.find("*/", at) + 2;
  if (text.compare(at, 2, "R\"") == 0 && !is_after_word) return end_of_raw_string(text, at);
  if (text[at] == '"' || (text[at] == '\'' && !is_after_word)) return end_of_quote(text, at);
  return std::nullopt;
}

}  // namespace

std::string code_of(const std::string& text) {
  std::string code;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::optional<std::size_t> end = end_of_noncode(text, at);
    if (!end) {
      code += text[at++];
      continue;
    }
    const std::size_t stop = std::min(*end, text.size());
    if (text[at] == '"' || text[at] == '\'' || text[at] == 'R') code += "\"\"";
    code += std::string(std::size_t(std::count(text.begin() + std::ptrdiff_t(at),
                                               text.begin() + std::ptrdiff_t(stop), '\n')),
                        '\n');
    at = stop;
  }
  return code;
}

std::vector<Type> types_of(const Source& source) {
  static const std::regex space(R"re(^(inline )?namespace ?([\w:]*) ?\{)re");
  static const std::string kind = "(?:struct|class|enum class|enum|union) (?:alignas\\([^)]*\\) )?";
  static const std::regex type("^(?:template <.*> )?" + kind +
                               R"re((\w+)( final)?( :.*| \{.*|;.*)?$)re");
  std::vector<std::string> spaces;
  std::vector<Type> types;
  for (std::size_t i = 0; i < source.lines.size(); ++i) {
    std::smatch match;
    const std::string& line = source.lines[i];
    if (std::regex_search(line, match, space)) {
      spaces.push_back(match[2]);
    } else if (line.starts_with("}  // namespace") && !spaces.empty()) {
      spaces.pop_back();
    } else if (std::regex_match(line, match, type)) {
      const std::string rest = code_of(match[3].str());
      const bool is_declaration =
          rest.find(';') != std::string::npos && rest.find('{') == std::string::npos;
      std::string name;
      for (const std::string& each : spaces)
        if (!each.empty()) name += each + "::";
      const bool is_anonymous = std::ranges::find(spaces, "") != spaces.end();
      types.push_back({name + match[1].str(), i + 1, is_anonymous, !is_declaration});
    }
  }
  return types;
}

}  // namespace isoline
