// Quoting by single quotes, within which a shell reads every letter but one as itself.
#include "core/shell.h"

#include <algorithm>

namespace isoline {
namespace {

bool is_literal(char letter) {
  constexpr std::string_view kSafe = "%+,-./:=@_";
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || kSafe.find(letter) != std::string_view::npos;
}

}  // namespace

std::string shell_word(std::string_view word) {
  if (!word.empty() && std::ranges::all_of(word, is_literal)) return std::string(word);
  std::string quoted = "'";
  for (const char letter : word)
    if (letter == '\'')
      quoted += "'\\''";  // ends the quotes, a quoted quote, begins them again
    else
      quoted += letter;
  return quoted + "'";
}

std::string shell_command(std::span<const char* const> words) {
  std::string command;
  for (const char* word : words) {
    if (!command.empty()) command += ' ';
    command += shell_word(word);
  }
  return command;
}

}  // namespace isoline
