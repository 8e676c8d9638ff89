// Which code ran, from g++ to libFuzzer: g++ calls a function at each edge (-fsanitize-coverage),
// and libFuzzer looks at counters of ours. Compiled without that option itself, and linked before
// libFuzzer's own function of that name, which only says that it expects another compiler.
#include <cstddef>
#include <cstdint>

namespace {

constexpr int kBits = 16;
// libFuzzer finds the section by its name.
__attribute__((section("__libfuzzer_extra_counters")))
std::uint8_t counters[std::size_t{1} << kBits];

}  // namespace

extern "C" void __sanitizer_cov_trace_pc() {
  constexpr std::uint64_t kGolden =
      0x9E3779B97F4A7C15;  // 2^64 / the golden ratio: spreads its bits
  const auto place = reinterpret_cast<std::uint64_t>(__builtin_return_address(0));
  std::uint8_t& counter = counters[(place * kGolden) >> (64 - kBits)];
  if (counter != UINT8_MAX) ++counter;
}

// Of comparisons g++ reports those of reals too, which libFuzzer does not ask for.
extern "C" void __sanitizer_cov_trace_cmpf(float, float) {}
extern "C" void __sanitizer_cov_trace_cmpd(double, double) {}
