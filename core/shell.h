// Words as a POSIX shell reads them back: what a record says was typed can be typed again.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace isoline {

// The word itself where a shell takes it literally, else in single quotes: it's -> 'it'\''s'.
std::string shell_word(std::string_view word);

// The words of a command, each quoted where it must be.
std::string shell_command(std::span<const char* const> words);

}  // namespace isoline
