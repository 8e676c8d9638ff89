// Hot loops allocate nothing: Eigen and the C++ library both come to malloc, which a program may
// define for itself. The sanitizers define it too, so not with them.
#include <gtest/gtest.h>

#include <cstdint>

#include "tests/optimizers/run.h"

namespace {
std::int64_t allocations = 0;  // plain: one thread
}

#ifndef ISOLINE_SANITIZE
extern "C" {
void* __libc_malloc(std::size_t size);  // glibc's own, under a second name

__attribute__((visibility("default"))) void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
}
#endif

namespace isoline {
namespace {

// FFTW allocates inside of a transform what we cannot give it.
bool transforms(const std::string& problem) { return problem == "poisson" || problem == "heat"; }

std::int64_t allocations_of_steps(const Problem& problem, const OptimizerEntry& entry) {
  const Json options = complete_options(entry.options, entry.name, Json::object());
  const auto method = entry.make(options, optimizers());
  const auto trace = std::make_unique<Trace>();
  Meter meter(problem, iterations(1000), needs_of(entry, options, problem), *trace);
  Vector theta = problem.start();
  meter.begin(theta);
  method->start(meter, theta);
  constexpr int kSteps = 3;  // the first sizes the state
  std::int64_t before = 0;
  for (int step = 0; step < kSteps; ++step) {
    if (step == 1) before = allocations;
    method->step(meter, theta);
    meter.iterate(theta);
  }
  return allocations - before;
}

TEST(Allocation, FirstOrderStepsAllocateNothingOnceWarm) {
  ProblemRegistry problems("problem");
  register_problems(problems);
  for (const auto& [problem_name, problem_entry] : problems) {
    if (transforms(problem_name)) continue;
    const Json options = complete_options(problem_entry.options, problem_name, Json::object());
    const Problem problem = problem_entry.make(options, Draw(0, problem_name));
    for (const auto& [name, entry] : optimizers()) {
      if (entry.family != Family::first_order) continue;
      EXPECT_EQ(allocations_of_steps(problem, entry), 0) << problem_name << " × " << name;
    }
  }
}

}  // namespace
}  // namespace isoline
