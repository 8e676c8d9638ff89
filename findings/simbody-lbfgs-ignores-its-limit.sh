#!/usr/bin/env bash
# Simbody 3.7: LBFGS and LBFGSB ignore setMaxIterations, and LBFGS the limits of parameters.
#
# Guess before the run: five iterations end after some tens of calls, with an error or the best
# point; an algorithm without bounds refuses a system that has them.
# Seen: on Rosenbrock's function with gradients by differences, a limit of 5 changes nothing: 277 calls
# by LBFGS and 270 by LBFGSB, as with 1,000. InteriorPoint throws an error at its limit; CMAES returns
# as if it had converged, at 6.5, and leaves a file in the working folder. With x1 <= 0.5 LBFGS ends at
# x1 = 1 without a word. Count calls in your own function, and take LBFGSB where there are bounds.
. "$(dirname "$0")/packages.sh"
debian libsimbody-dev=3.7+dfsg-3
cat >"$work/run.cpp" <<'C'
#include <SimTKmath.h>
#include <cstdio>
using namespace SimTK;

static int calls;
struct Rosenbrock : OptimizerSystem {
  explicit Rosenbrock(bool bounded) : OptimizerSystem(2) {
    if (bounded) setParameterLimits(Vector(Vec2(-2, -2)), Vector(Vec2(0.5, 2)));
  }
  int objectiveFunc(const Vector& x, bool, Real& f) const override {
    const double a = x[1] - x[0] * x[0], b = 1 - x[0];
    ++calls;
    f = 100 * a * a + b * b;
    return 0;
  }
};
static void run(const char* name, OptimizerAlgorithm which, bool bounded, int limit) {
  const Rosenbrock system(bounded);
  Vector x(2);
  x[0] = -1.2;
  x[1] = 1;
  calls = 0;
  std::printf("%s, limit %d%s: ", name, limit, bounded ? ", bounds" : "");
  try {
    Optimizer optimizer(system, which);
    optimizer.setMaxIterations(limit);
    optimizer.useNumericalGradient(true);
    if (which == CMAES) {
      optimizer.setAdvancedIntOption("seed", 42);
      optimizer.setAdvancedRealOption("init_stepsize", 0.3);
    }
    const double f = optimizer.optimize(x);
    std::printf("x1 %.2f, f %.2f", x[0], f);
  } catch (const std::exception&) {
    std::printf("error");
  }
  std::printf(", %s calls\n", calls < 100 ? "below 100" : calls < 200 ? "100 to 200" : calls < 300 ? "200 to 300" : "more");
}
int main() {
  const OptimizerAlgorithm which[] = {InteriorPoint, LBFGS, LBFGSB, CMAES};
  const char* names[] = {"InteriorPoint", "LBFGS", "LBFGSB", "CMAES"};
  for (int i = 0; i < 4; ++i) {
    run(names[i], which[i], false, 1000);
    run(names[i], which[i], false, 5);
    run(names[i], which[i], true, 1000);
  }
}
C
compile "$work/run.cpp" -std=c++17 -I"$root/usr/include/simbody" -lSimTKmath -lSimTKcommon
cd "$work"  # CMAES writes a file
expect 'InteriorPoint, limit 1000: x1 1.00, f 0.00, 200 to 300 calls
InteriorPoint, limit 5: error, below 100 calls
InteriorPoint, limit 1000, bounds: x1 0.50, f 0.25, 100 to 200 calls
LBFGS, limit 1000: x1 1.00, f 0.00, 200 to 300 calls
LBFGS, limit 5: x1 1.00, f 0.00, 200 to 300 calls
LBFGS, limit 1000, bounds: x1 1.00, f 0.00, 200 to 300 calls
LBFGSB, limit 1000: x1 1.00, f 0.00, 200 to 300 calls
LBFGSB, limit 5: x1 1.00, f 0.00, 200 to 300 calls
LBFGSB, limit 1000, bounds: x1 0.50, f 0.25, 200 to 300 calls
CMAES, limit 1000: x1 1.00, f 0.00, more calls
CMAES, limit 5: x1 -0.59, f 6.49, below 100 calls
CMAES, limit 1000, bounds: x1 0.50, f 0.25, more calls' "$work/program"
