// One step of each method written here over the bare linear algebra that it needs.

#include <fmt/format.h>

#include "benchmarks/micro/bare_steps.h"
#include "benchmarks/micro/pairs.h"
#include "benchmarks/micro/trial.h"

namespace isoline::benchmarks::micro {

using optimizers::Family;
namespace {

// Tiny, where overhead shows; middling; and two grids whose transforms allocate inside FFTW.
const char* const kProblems[] = {"rosenbrock", "broyden-tridiagonal[n=100]", "poisson[N=8]",
                                 "heat[N=8]"};

bool factorizes(const OracleSet& needs) {
  return needs.contains(Oracle::jacobian) || needs.contains(Oracle::hessian);
}

// A few steps from the start, before the method has converged; the first, untimed, sizes its state.
Cost steps_of_ours(Trial& trial, int steps) {
  Vector theta = trial.problem.start();
  trial.method->start(trial.meter, theta);
  trial.method->step(trial.meter, theta);
  return cost_of(steps, [&] { trial.method->step(trial.meter, theta); });
}

Cost bare_steps(const Problem& problem, const BareStep& step, int steps) {
  Vector theta = problem.start();
  step(theta);
  return cost_of(steps, [&] { step(theta); });
}

Pair make(const std::string& name, const std::string& problem_spec) {
  const auto problem = std::make_shared<const Problem>(make_problem(problem_spec));
  const auto trial = std::make_shared<Trial>(*problem, name, endless());
  const BareStep step = bare_step(name, *problem);
  trial->meter.begin(problem->start());
  const int steps = factorizes(needs(name, *problem)) ? 4 : 32;
  return {[=] { return steps_of_ours(*trial, steps); },
          [=] { return bare_steps(*problem, step, steps); }};
}

bool is_written_here(Family family) {
  return family == Family::first_order || family == Family::curvature ||
         family == Family::inversion;
}

}  // namespace

void register_steps() {
  for (const std::string problem_spec : kProblems) {
    const Problem problem = make_problem(problem_spec);
    for (const auto& [name, entry] : catalog().optimizers.ready()) {
      const OptionValues options = complete_optimizer(catalog(), name, OptionValues()).options;
      if (!is_written_here(entry.family)) continue;
      if (!why_inapplicable(entry, options, problem).empty()) continue;
      const int pairs = factorizes(needs(name, problem)) ? 41 : 401;
      register_pair(fmt::format("step/{}/{}", name, problem_spec), pairs, {},
                    [name = name, problem_spec] { return make(name, problem_spec); });
    }
  }
}

}  // namespace isoline::benchmarks::micro
