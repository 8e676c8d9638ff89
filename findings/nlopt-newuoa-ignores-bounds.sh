#!/usr/bin/env bash
# NLopt 2.7.1: LN_NEWUOA takes bounds without an error and ignores them; it ends with success outside.
#
# Guess before the run: an algorithm without bounds refuses them (NLOPT_INVALID_ARGS), as those without constraints do.
# Seen: on Rosenbrock's function with x1 <= 0.5, LN_NEWUOA returns 1 (SUCCESS) at (1, 1), 93 of 175 calls outside. The 39
# others that Debian's build has make no call outside. Use LN_BOBYQA, or LN_NEWUOA_BOUND.
. "$(dirname "$0")/packages.sh"
debian libnlopt-dev=2.7.1-5 libnlopt0=2.7.1-5
cat >"$work/run.c" <<'C'
#include <nlopt.h>
#include <stdio.h>

static int calls, outside;
static double loss(unsigned n, const double *x, double *slope, void *nothing) {
  const double a = x[1] - x[0] * x[0], b = 1 - x[0];
  ++calls;
  outside += x[0] < -2 || x[0] > 0.5 || x[1] < -2 || x[1] > 2;
  if (slope) slope[0] = -400 * a * x[0] - 2 * b, slope[1] = 200 * a;
  return 100 * a * a + b * b;
}
static void run(const char *name, nlopt_algorithm algorithm) {
  const double lower[2] = {-2, -2}, upper[2] = {0.5, 2};
  double x[2] = {-1.2, 1}, value;
  nlopt_opt method = nlopt_create(algorithm, 2);
  const int taken = nlopt_set_lower_bounds(method, lower) + nlopt_set_upper_bounds(method, upper);
  calls = outside = 0;
  nlopt_set_min_objective(method, loss, 0);
  nlopt_set_xtol_rel(method, 1e-8);
  const int code = nlopt_optimize(method, x, &value);
  printf("%s: bounds %s, code %d, x1 = %.3f, outside %s\n", name, taken == 2 ? "taken" : "refused", code, x[0],
         outside > 0 ? "yes" : "no");
}
int main(void) {
  run("LN_NEWUOA", NLOPT_LN_NEWUOA);
  run("LN_NEWUOA_BOUND", NLOPT_LN_NEWUOA_BOUND);
  run("LN_BOBYQA", NLOPT_LN_BOBYQA);
}
C
compile "$work/run.c" -lnlopt -lm
expect 'LN_NEWUOA: bounds taken, code 1, x1 = 1.000, outside yes
LN_NEWUOA_BOUND: bounds taken, code 1, x1 = 0.500, outside no
LN_BOBYQA: bounds taken, code 4, x1 = 0.500, outside no' "$work/program"
