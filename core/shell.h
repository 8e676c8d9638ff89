// Words as a POSIX shell reads them back: what a record says was typed can be typed again.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isoline {

// The word itself where a shell takes it literally, else in single quotes: it's -> 'it'\''s'.
std::string shell_word(std::string_view word);

// The words of a command, each quoted where it must be.
std::string shell_command(std::span<const char* const> words);

// The words of a command, split and unquoted as a shell does it, and nothing expanded: no variable,
// no pattern, no pipe. UsageError where a quote stays open or there is no word at all.
std::vector<std::string> shell_words(std::string_view command);

}  // namespace isoline
