// Micro-benchmarks: what we add to the bare library or to the physical limit, as ratios measured in
// one run. Choose by --benchmark_filter=metering.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "benchmarks/micro/pairs.h"
#include "core/threads.h"

namespace isoline::benchmarks::micro {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Readings {
  std::vector<double> ours, bare, ratio, extra;  // ns, but for the ratio

  void add(const Cost& a, const Cost& b) {
    ours.push_back(1e9 * a.seconds);
    bare.push_back(1e9 * b.seconds);
    ratio.push_back(a.seconds / b.seconds);
    extra.push_back(1e9 * (a.seconds - b.seconds));
  }

  void report(benchmark::State& state, const Goal& goal) const {
    state.counters["ns"] = median(ours);
    state.counters["bare_ns"] = median(bare);
    state.counters["ratio"] = median(ratio);
    state.counters["extra_ns"] = median(extra);
    if (goal.ratio > 0) state.counters["goal_ratio"] = goal.ratio;
    if (goal.extra_ns > 0) state.counters["goal_extra_ns"] = goal.extra_ns;
  }
};

void compare(benchmark::State& state, const Pair& pair, const Goal& goal) {
  Readings readings;
  pair.ours();  // warm
  pair.bare();
  bool ours_first = true;
  for (auto _ : state) {
    Cost a, b;
    if (ours_first) a = pair.ours();
    b = pair.bare();
    if (!ours_first) a = pair.ours();
    ours_first = !ours_first;
    state.SetIterationTime(a.seconds);
    readings.add(a, b);
  }
  readings.report(state, goal);
}

}  // namespace

void register_pair(const std::string& name, int pairs, const Goal& goal,
                   const std::function<Pair()>& make) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) { compare(state, make(), goal); })
      ->Iterations(pairs)
      ->UseManualTime();
}

}  // namespace isoline::benchmarks::micro

int main(int count, char** arguments) {
  using namespace isoline::benchmarks::micro;
  isoline::prepare_libraries(arguments);
  register_metering();
  register_libraries();
  register_grids();
  register_round_trips();
  register_spectral();
  register_networks();  // raises the threads of the whole program, and is therefore last
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
