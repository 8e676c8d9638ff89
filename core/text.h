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

// Counts that are named before they are made: products and sums that stop at the largest number.

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

// "unknown WHAT 'wrong'; did you mean 'right'?", or the list of what is known.
std::string unknown_name(std::string_view what, std::string_view wrong,
                         const std::vector<std::string>& known);

}  // namespace isoline
