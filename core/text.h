// The only entry for external text: of components and their errors, of files, of command lines and
// paths. Input is made valid UTF-8; output to a terminal loses its control sequences.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace isoline {

// Replaces each invalid byte by U+FFFD. Valid UTF-8 stays as it is.
std::string valid_utf8(std::string_view text);

// The beginning of a text: complete characters of at most this number of bytes.
std::string_view cut(std::string_view text, std::size_t most_bytes);

// Text that is safe for a terminal: valid UTF-8 with `\u001b` for characters that would move the
// cursor, change colours or change the direction of the text. Line ends and tabs stay. JSON stays
// the same JSON.
std::string printable(std::string_view text);

// Prints text for the user, made printable. All output goes through this function. Throws if the
// output cannot be written.
void say(std::FILE* out, std::string_view text);

// Numbers of things that do not exist yet: products and sums saturate at the largest number.

inline constexpr std::uint64_t kUncountable = std::numeric_limits<std::uint64_t>::max();

// The largest iterations and work of a budget: their sums and products still fit.
inline constexpr std::int64_t kMostAmount = 1'000'000'000'000'000;

inline std::uint64_t product_of(std::uint64_t a, std::uint64_t b) {
  return b != 0 && a > kUncountable / b ? kUncountable : a * b;
}
inline std::uint64_t sum_of(std::uint64_t a, std::uint64_t b) {
  return a > kUncountable - b ? kUncountable : a + b;
}

std::string count_text(std::uint64_t count);  // "50,000"; of kUncountable "more than 10^19"

// The known name nearest by edit distance, if near enough to be meant; else empty.
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& known);

// "unknown WHAT 'wrong'; did you mean 'right'?", or the list of known names.
std::string unknown_name(std::string_view what, std::string_view wrong,
                         const std::vector<std::string>& known);

}  // namespace isoline
