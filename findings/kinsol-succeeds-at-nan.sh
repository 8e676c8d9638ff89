#!/usr/bin/env bash
# SUNDIALS 6.4.1 KINSOL: Newton's method ends with KIN_SUCCESS where the equation has no value.
#
# Guess before the run: a system that becomes NaN after a step ends with an error, as CVODE, ARKODE
# and IDA do where their right-hand side becomes NaN.
# Seen: log p = 0 from p = 10 with the full step (KIN_NONE): after three calls p is -13.03, the norm
# that KINGetFuncNorm gives is NaN, and the code is 0, KIN_SUCCESS. If the function returns 1, a
# recoverable failure, in place of NaN, p = 1 is found, after 71 calls, half of them without a value;
# with the constraint p > 0 after three. Return a code for each missing value, and test the norm.
. "$(dirname "$0")/packages.sh"
debian libsundials-dev=6.4.1+dfsg1-3
cat >"$work/run.c" <<'C'
#include <kinsol/kinsol.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

static int calls, missing, failure;
static int equation(N_Vector p, N_Vector f, void *nothing) {
  const double v = N_VGetArrayPointer(p)[0];
  ++calls;
  missing += v <= 0;
  N_VGetArrayPointer(f)[0] = v > 0 ? log(v) : NAN;
  return v > 0 ? 0 : failure;
}
static void run(const char *name, int code, double constraint) {
  SUNContext context;
  SUNContext_Create(NULL, &context);
  N_Vector p = N_VNew_Serial(1, context), one = N_VNew_Serial(1, context), kept = N_VNew_Serial(1, context);
  SUNMatrix matrix = SUNDenseMatrix(1, 1, context);
  void *memory = KINCreate(context);
  double norm;
  failure = code;
  calls = missing = 0;
  N_VConst(10, p);
  N_VConst(1, one);
  N_VConst(constraint, kept);
  KINInit(memory, equation, p);
  KINSetLinearSolver(memory, SUNLinSol_Dense(p, matrix, context), matrix);
  if (constraint) KINSetConstraints(memory, kept);
  const int ended = KINSol(memory, p, KIN_NONE, one, one);
  KINGetFuncNorm(memory, &norm);
  printf("%s: code %d, p %.2f, norm %s, %d calls, %d without a value\n", name, ended, N_VGetArrayPointer(p)[0],
         isnan(norm) ? "NaN" : norm < 1e-5 ? "small" : "large", calls, missing);
}
int main(void) {
  run("NaN", 0, 0);
  run("NaN and a code", 1, 0);
  run("constraint", 0, 2);
}
C
compile "$work/run.c" -lsundials_kinsol -lsundials_nvecserial -lsundials_sunmatrixdense -lsundials_sunlinsoldense \
  -lsundials_generic -lm
expect 'NaN: code 0, p -13.03, norm NaN, 3 calls, 1 without a value
NaN and a code: code 0, p 1.00, norm small, 71 calls, 35 without a value
constraint: code 0, p 1.00, norm small, 3 calls, 0 without a value' "$work/program"
