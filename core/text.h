// The one door for text that others wrote: of components and their errors, of files, of command
// lines and paths. What comes in is made valid; what goes to a terminal is made harmless.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace isoline {

// With U+FFFD for all that is no UTF-8; what is valid stays as it is, to the byte.
std::string valid_utf8(std::string_view text);

// The beginning of a text, of so many bytes at most, and of whole characters.
std::string_view cut(std::string_view text, std::size_t most_bytes);

// As a terminal may have it: valid, and with `\u001b` written for what would move its cursor,
// change its colours or turn the direction of what follows. Line ends and tabs stay. What is JSON
// stays the same JSON.
std::string printable(std::string_view text);

// All that a user reads on standard output and standard error goes through here, printable. Throws
// where it cannot be written.
void say(std::FILE* out, std::string_view text);

}  // namespace isoline
