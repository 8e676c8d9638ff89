// Micro-benchmarks: what we add to the bare library or to the physical limit, as ratios measured in
// one run. Choose by --benchmark_filter=metering.
#include <benchmark/benchmark.h>

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
