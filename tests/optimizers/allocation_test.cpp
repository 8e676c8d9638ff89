// Hot loops allocate nothing: Eigen and the C++ library both come to malloc, which a program may
// define for itself. The sanitizers define it too, so not with them.
#include <gtest/gtest.h>

#include <cstdint>

#include "core/threads.h"
#include "tests/optimizers/run.h"
#include "tests/optimizers/trial_problems.h"

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

namespace isoline::optimizers {
namespace {

// FFTW allocates inside of a transform what we cannot give it.
bool transforms(const std::string& problem) {
  return problem == "heat" || problem == "heat-1d" || problem == "navier-stokes";
}

std::int64_t allocations_of_steps(const Problem& problem, const std::string& spec) {
  const OptimizerEntry& entry = optimizers().at(parse_spec(spec).name);
  const OptionValues options = options_of_spec(entry, spec);
  const auto method = entry.make(options, optimizers());
  const auto trace = std::make_unique<Trace>();
  Meter meter(problem, iterations(1000), needs_of(entry, options, problem), *trace);
  Vector theta = problem.start();
  meter.begin(theta);
  method->start(meter, theta);
  method->step(meter, theta);  // sizes the state
  const std::int64_t before = allocations;
  method->step(meter, theta);
  method->step(meter, theta);
  return allocations - before;
}

TEST(Allocation, FirstOrderStepsAllocateNothingOnceWarm) {
  set_library_threads(1);  // OpenBLAS allocates for each product that it divides among threads
  for (const std::string& problem_name : problems::all_problems().ready().names()) {
    if (transforms(problem_name) || problem_name == "conduct") continue;  // it keeps its calls
    const Problem problem = make(problem_name);
    for (const auto& [name, entry] : optimizers()) {
      if (entry.family != Family::first_order) continue;
      EXPECT_EQ(allocations_of_steps(problem, name), 0) << problem_name << " × " << name;
    }
  }
}

// Of evaluations of a matrix at a point, once the work space is sized.
template <class F>
std::int64_t allocations_of(const Problem& problem, const F& fill) {
  Point at;
  Matrix all;
  std::int64_t before = 0;
  for (int i = 0; i < 2; ++i) {
    before = allocations;
    problem.forward(problem.start(), at);
    fill(all, at);
  }
  return allocations - before;
}

// By formula, by products, through a network, and row by row through one without its own.
TEST(Allocation, JacobiansAndHessiansAllocateNothingOnceWarm) {
  const auto of_jacobian = [](const Problem& problem) {
    return allocations_of(problem, [&](Matrix& J, Point& at) { problem.jacobian(J, at); });
  };
  for (const char* spec : {"rosenbrock", "broyden-tridiagonal[n=20]", "sine[mode=learn]", "hig-toy",
                           "exponential[mode=learn]", "variably-dimensioned", "linear-chain",
                           "coupled-oscillators[mode=learn]", "quantum-dipole[mode=learn]",
                           "quantum-dipole[loss=residual]", "poisson-hig"})
    EXPECT_EQ(of_jacobian(make(spec)), 0) << spec;
  EXPECT_EQ(of_jacobian(learned_affine(6)), 0) << "a network without its own";
  for (const char* spec : {"rosenbrock", "brown-dennis", "wood"}) {
    const Problem problem = make(spec);
    const auto hessian = [&](Matrix& H, Point& at) { problem.hessian(H, at); };
    EXPECT_EQ(allocations_of(problem, hessian), 0) << spec;
  }
}

// A local inverse returns its successes, an array of its own.
TEST(Allocation, TrainingStepsAllocateNothingOnceWarm) {
  const Problem problem = learned_affine(6);
  for (const char* spec :
       {"sip[inverse=newton]", "sip[inverse=newton,inner-steps=2]", "supervised", "rescaled",
        "rescaled[by=truth]", "adahessian", "hessian-free", "kfac", "muon", "soap"})
    EXPECT_EQ(allocations_of_steps(problem, spec), 0) << spec;
}

}  // namespace
}  // namespace isoline::optimizers
