// Counts that are named before they are made: products and sums that stop at the largest number.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace isoline {

inline constexpr std::uint64_t kUncountable = std::numeric_limits<std::uint64_t>::max();

// Most iterations, and most work, that can be asked for: their sums and products still fit.
inline constexpr std::int64_t kMostAmount = 1'000'000'000'000'000;

inline std::uint64_t product_of(std::uint64_t a, std::uint64_t b) {
  return b != 0 && a > kUncountable / b ? kUncountable : a * b;
}
inline std::uint64_t sum_of(std::uint64_t a, std::uint64_t b) {
  return a > kUncountable - b ? kUncountable : a + b;
}

std::string count_text(std::uint64_t count);  // "50,000"; of kUncountable "more than 10^19"

}  // namespace isoline
