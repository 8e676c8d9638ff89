#!/usr/bin/env bash
# SUNDIALS 6.4.1 CVODE: every value depends on the first output time, and on sensitivities.
#
# Guess before the run: output is interpolated, so y(7.3) has the same bits whatever times are asked
# for before it; and sensitivities that are left out of the error test (the default) leave y as it
# is.
# Seen: van der Pol's oscillator, y_1(7.3) at mu = 2 is 1.88399. At a tolerance of 1e-5 CVODE gives
# 1.88392 to 1.88458: the first step is chosen by the distance to the first time, and all that
# follow come from it. With staggered sensitivities two of the four values differ. CVodeSetInitStep
# ends both: all eight are one number. Data with one more early time have another model, by 66 times
# the tolerance; where the first time depends on an unknown, y(p) jumps with it. At 1e-9 the values
# agree to seven digits.
. "$(dirname "$0")/packages.sh"
debian libsundials-dev=6.4.1+dfsg1-3
cat >"$work/run.c" <<'C'
#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

static double parameter[1];
static int slope(double t, N_Vector y, N_Vector f, void *nothing) {
  const double *v = N_VGetArrayPointer(y);
  double *d = N_VGetArrayPointer(f);
  d[0] = v[1];
  d[1] = parameter[0] * (1 - v[0] * v[0]) * v[1] - v[0];
  return 0;
}
static double at_end(double tolerance, double first, int sensitive, double step) {
  SUNContext context;
  SUNContext_Create(NULL, &context);
  N_Vector y = N_VNew_Serial(2, context), *s;
  SUNMatrix matrix = SUNDenseMatrix(2, 2, context);
  void *memory = CVodeCreate(CV_BDF, context);
  double t;
  parameter[0] = N_VGetArrayPointer(y)[0] = 2;
  N_VGetArrayPointer(y)[1] = 0;
  CVodeInit(memory, slope, 0, y);
  CVodeSStolerances(memory, tolerance, tolerance);
  CVodeSetLinearSolver(memory, SUNLinSol_Dense(y, matrix, context), matrix);
  CVodeSetUserData(memory, parameter);
  CVodeSetMaxNumSteps(memory, 100000);
  if (step > 0) CVodeSetInitStep(memory, step);
  if (sensitive) {
    s = N_VCloneVectorArray(1, y);
    N_VConst(0, s[0]);
    CVodeSensInit(memory, 1, CV_STAGGERED, NULL, s);
    CVodeSensEEtolerances(memory);
    CVodeSetSensParams(memory, parameter, NULL, NULL);
  }
  CVode(memory, first, y, &t, CV_NORMAL);
  CVode(memory, 7.3, y, &t, CV_NORMAL);
  return N_VGetArrayPointer(y)[0];
}
int main(void) {
  const double first[] = {0.001, 0.01, 0.1, 3};
  for (int i = 0; i < 4; ++i) {
    printf("first at %g: %.5f, with sensitivities %.5f;", first[i], at_end(1e-5, first[i], 0, 0),
           at_end(1e-5, first[i], 1, 0));
    printf(" from a step of 1e-3: %.5f, %.5f; at 1e-9: %.7f\n", at_end(1e-5, first[i], 0, 1e-3),
           at_end(1e-5, first[i], 1, 1e-3), at_end(1e-9, first[i], 0, 0));
  }
}
C
compile "$work/run.c" -lsundials_cvodes -lsundials_nvecserial -lsundials_sunmatrixdense -lsundials_sunlinsoldense \
  -lsundials_generic -lm
expect 'first at 0.001: 1.88458, with sensitivities 1.88458; from a step of 1e-3: 1.88428, 1.88428; at 1e-9: 1.8839859
first at 0.01: 1.88403, with sensitivities 1.88414; from a step of 1e-3: 1.88428, 1.88428; at 1e-9: 1.8839859
first at 0.1: 1.88392, with sensitivities 1.88387; from a step of 1e-3: 1.88428, 1.88428; at 1e-9: 1.8839859
first at 3: 1.88405, with sensitivities 1.88405; from a step of 1e-3: 1.88428, 1.88428; at 1e-9: 1.8839859' "$work/program"
