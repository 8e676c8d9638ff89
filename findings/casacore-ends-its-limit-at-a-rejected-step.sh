#!/usr/bin/env bash
# casacore 3.5.0 NonLinearFitLM: at its limit it returns the last trial, with a chi-square of none.
#
# Guess before the run: a fit that its limit ends returns the best parameters so far, not converged,
# with their chi-square.
# Seen: a exp(-b t) to ten data. After one iteration, and after three, it is not converged, and its
# solution is the last trial, with a sum of squares of 198 and 194, where the start has 4.5 and the
# least is 0.00087; chiSquare() is near 9, a difference of large numbers. The errors, 3e-6 and 2e-7,
# look as those of a good fit. Converged, all agree, and errors come from the residuals, whatever
# sigma is given. Test converged() before anything else.
. "$(dirname "$0")/packages.sh"
debian casacore-dev=3.5.0-2+b3
cat >"$work/run.cpp" <<'C'
#include <casacore/casa/Arrays/Vector.h>
#include <casacore/scimath/Fitting/NonLinearFitLM.h>
#include <casacore/scimath/Functionals/CompiledFunction.h>
#include <casacore/scimath/Mathematics/AutoDiff.h>
#include <cmath>
#include <cstdio>
using namespace casacore;

static Vector<Double> t(10), y(10);
static double squares(double a, double b) {
  double sum = 0;
  for (int i = 0; i < 10; ++i) sum += std::pow(y[i] - a * std::exp(-b * t[i]), 2);
  return sum;
}
static void run(int limit, double deviation) {
  CompiledFunction<AutoDiff<Double>> model;
  model.setFunction("p0*exp(-p1*x)");
  for (int k = 0; k < 2; ++k) model[k] = AutoDiff<Double>(1, 2, k);
  NonLinearFitLM<Double> fit;
  fit.setFunction(model);
  fit.setMaxIter(limit);
  fit.setCriteria(1e-8);
  const Vector<Double> p = fit.fit(t, y, Vector<Double>(10, deviation)), errors = fit.errors();
  const double chi = fit.chiSquare() * deviation * deviation, sum = squares(p[0], p[1]);
  std::printf("limit %d, sigma %g: converged %d, squares %.2g, start %.2f, chi-square %s, errors %.0e and %.0e\n", limit,
              deviation, static_cast<int>(fit.converged()), sum, squares(1, 1),
              std::fabs(chi - sum) < 1e-6 * sum ? "agrees" : "differs", errors[0], errors[1]);
}
int main() {
  const double noise[] = {3, -11, 8, 15, -2, -14, 6, 1, -9, 12};
  for (int i = 0; i < 10; ++i) {
    t[i] = i;
    y[i] = 2 * std::exp(-0.3 * i) + noise[i] / 1000;
  }
  run(1, 1);
  run(3, 1);
  run(30, 1);
  run(30, 0.01);
}
C
compile "$work/run.cpp" -std=c++17 -lcasa_scimath -lcasa_scimath_f -lcasa_casa -Wl,--unresolved-symbols=ignore-in-shared-libs
expect 'limit 1, sigma 1: converged 0, squares 2e+02, start 4.51, chi-square differs, errors 3e-06 and 2e-07
limit 3, sigma 1: converged 0, squares 1.9e+02, start 4.51, chi-square differs, errors 4e-06 and 2e-07
limit 30, sigma 1: converged 1, squares 0.00087, start 4.51, chi-square agrees, errors 9e-03 and 2e-03
limit 30, sigma 0.01: converged 1, squares 0.00087, start 4.51, chi-square agrees, errors 9e-03 and 2e-03' "$work/program"
