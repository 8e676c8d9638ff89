// What CPUID says: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2A, and the
// registers that the system keeps by XGETBV, volume 1, 13.3.
#include "core/processor.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#ifdef __x86_64__
#include <cpuid.h>
#endif

namespace isoline {

bool Processor::has(const std::string& feature) const {
  return std::find(features.begin(), features.end(), feature) != features.end();
}

namespace {

#ifdef __x86_64__

using Registers = std::array<unsigned, 4>;  // eax, ebx, ecx, edx

Registers cpuid(unsigned leaf, unsigned part = 0) {
  Registers r{};
  __get_cpuid_count(leaf, part, &r[0], &r[1], &r[2], &r[3]);  // zeros beyond the last leaf
  return r;
}

std::string brand() {
  constexpr unsigned kFirst = 0x80000002;  // three leaves of sixteen characters
  std::string text;
  for (unsigned leaf = kFirst; leaf < kFirst + 3; ++leaf)
    for (const unsigned four : cpuid(leaf))
      for (int shift = 0; shift < 32; shift += 8)
        if (const auto letter = static_cast<char>(four >> shift & 0xFF)) text += letter;
  const auto begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "unknown"
                                    : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

// Parts of the registers' state that the system saves, as bits of XCR0.
constexpr std::uint64_t kAlways = 0, kAvx = 0x06, kAvx512 = 0xE6, kTiles = 0x60000;

std::uint64_t kept_state() {
  constexpr unsigned kOsxsave = 1U << 27;
  if ((cpuid(1)[2] & kOsxsave) == 0) return 0;
  unsigned low = 0, high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return std::uint64_t{high} << 32 | low;
}

struct Feature {
  std::string_view name;
  unsigned leaf, part, word, bit;  // word: 0 eax, 1 ebx, 2 ecx, 3 edx
  std::uint64_t state;
};

constexpr Feature kFeatures[] = {
    {"sse3", 1, 0, 2, 0, kAlways},
    {"ssse3", 1, 0, 2, 9, kAlways},
    {"sse4_1", 1, 0, 2, 19, kAlways},
    {"sse4_2", 1, 0, 2, 20, kAlways},
    {"avx", 1, 0, 2, 28, kAvx},
    {"f16c", 1, 0, 2, 29, kAvx},
    {"fma", 1, 0, 2, 12, kAvx},
    {"avx2", 7, 0, 1, 5, kAvx},
    {"bmi1", 7, 0, 1, 3, kAlways},
    {"bmi2", 7, 0, 1, 8, kAlways},
    {"avx_vnni", 7, 1, 0, 4, kAvx},
    {"avx512f", 7, 0, 1, 16, kAvx512},
    {"avx512dq", 7, 0, 1, 17, kAvx512},
    {"avx512cd", 7, 0, 1, 28, kAvx512},
    {"avx512bw", 7, 0, 1, 30, kAvx512},
    {"avx512vl", 7, 0, 1, 31, kAvx512},
    {"avx512_vnni", 7, 0, 2, 11, kAvx512},
    {"avx512_bf16", 7, 1, 0, 5, kAvx512},
    {"avx512_fp16", 7, 0, 3, 23, kAvx512},
    {"amx_tile", 7, 0, 3, 24, kTiles},
};

Processor read_processor() {
  Processor read{.brand = brand(), .features = {}};
  const std::uint64_t kept = kept_state();
  for (const Feature& f : kFeatures)
    if ((cpuid(f.leaf, f.part)[f.word] >> f.bit & 1) != 0 && (kept & f.state) == f.state)
      read.features.emplace_back(f.name);
  return read;
}

#else

Processor read_processor() { return {.brand = "unknown", .features = {}}; }

#endif

}  // namespace

const Processor& processor() {
  static const Processor read = read_processor();
  return read;
}

}  // namespace isoline
