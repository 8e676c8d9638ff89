// FNV-1a, 64 bits (Fowler, Noll, Vo): names files by what they hold and keys random streams.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace isoline {

inline constexpr std::uint64_t kDigestStart = 0xcbf29ce484222325;

constexpr std::uint64_t fnv1a(std::string_view text, std::uint64_t state = kDigestStart) {
  constexpr std::uint64_t kPrime = 0x100000001b3;
  for (const char letter : text) state = (state ^ static_cast<unsigned char>(letter)) * kPrime;
  return state;
}

std::string digest(std::string_view text);  // as 16 hexadecimal digits

}  // namespace isoline
