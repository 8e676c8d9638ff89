// Micro-benchmarks: what we add to the bare library or to the physical limit, as ratios measured in
// one run. Choose by --benchmark_filter=metering.
#include <benchmark/benchmark.h>

#include <cstddef>

#include "benchmarks/micro/pairs.h"
#include "core/threads.h"

int main(int count, char** arguments) {
  isoline::prepare_libraries(arguments);
  isoline::benchmarks::micro::register_metering();
  isoline::benchmarks::micro::register_steps();
  isoline::benchmarks::micro::register_training();
  isoline::benchmarks::micro::register_libraries();
  isoline::benchmarks::micro::register_transforms();
  isoline::benchmarks::micro::register_fluid();
  isoline::benchmarks::micro::register_networks();
  isoline::benchmarks::micro::register_isolation();
  isoline::benchmarks::micro::register_round_trips();
  isoline::benchmarks::micro::register_unet();
  isoline::benchmarks::micro::register_spectral();
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

// Counts what is allocated: Eigen, the C++ library and LAPACKE all come to malloc, which a program
// may define for itself and its shared libraries. The sanitizers define it too, so not with them.
namespace {
std::int64_t calls = 0;  // plain: the program has one thread
}

#ifndef ISOLINE_SANITIZE
extern "C" {
// glibc's own, under a second name that is not ours to choose.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming)
void* __libc_malloc(std::size_t size);

__attribute__((visibility("default"))) void* malloc(std::size_t size) noexcept {
  ++calls;
  return __libc_malloc(size);
}
}
#endif

namespace isoline::benchmarks::micro {

std::int64_t allocations() { return calls; }

}  // namespace isoline::benchmarks::micro
