#!/usr/bin/env bash
# CHOLMOD 5.12.0, Eigen 3.4.0 and GSL 2.7.1: a Matrix Market file by Fortran's D format is read with success, without its exponents.
#
# Guess before the run: a reader takes 2.5D+01, as Fortran writes it, as 25, or refuses the file.
# Seen: all three take the digits before the D alone: 2.5 for 25, 1.5 for 0.0015, with a status of success and without a
# word. SciPy's mmread and R's readMM refuse the file. Replace D by E before you read it.
. "$(dirname "$0")/packages.sh"
debian libsuitesparse-dev=1:5.12.0+dfsg-2 libcholmod3=1:5.12.0+dfsg-2 libsuitesparseconfig5=1:5.12.0+dfsg-2 \
  libeigen3-dev=3.4.0-4 libgsl-dev=2.7.1+dfsg-5+deb12u1 libgsl27=2.7.1+dfsg-5+deb12u1 libgslcblas0=2.7.1+dfsg-5+deb12u1 \
  python3-scipy=1.10.1-2 python3-numpy=1:1.24.2-1+deb12u1
cat >"$work/a.mtx" <<'M'
%%MatrixMarket matrix coordinate real general
2 2 3
1 1 2.5D+01
2 1 1.5D-03
2 2 4.0E+00
M
cat >"$work/load.cpp" <<'C'
#include <cstdio>
#include <gsl/gsl_spmatrix.h>
#include <suitesparse/cholmod.h>
#include <unsupported/Eigen/SparseExtra>
int main(int, char** names) {
  cholmod_common common;
  cholmod_start(&common);
  cholmod_sparse* const a = cholmod_read_sparse(std::fopen(names[1], "r"), &common);
  const double* const x = static_cast<double*>(a->x);
  std::printf("CHOLMOD: status %d, %g %g %g\n", common.status, x[0], x[1], x[2]);
  Eigen::SparseMatrix<double> b;
  const bool good = Eigen::loadMarket(b, names[1]);
  std::printf("Eigen: %d, %g %g %g\n", good, b.coeff(0, 0), b.coeff(1, 0), b.coeff(1, 1));
  const gsl_spmatrix* const c = gsl_spmatrix_fscanf(std::fopen(names[1], "r"));
  std::printf("GSL: %d, %g %g %g\n", c != nullptr, gsl_spmatrix_get(c, 0, 0), gsl_spmatrix_get(c, 1, 0),
              gsl_spmatrix_get(c, 1, 1));
}
C
compile "$work/load.cpp" -lcholmod -lgsl -lgslcblas
cat >"$work/load.py" <<'P'
import sys

from scipy.io import mmread

try:
    print("SciPy:", mmread(sys.argv[1]).toarray().tolist())
except ValueError as error:
    print("SciPy:", error)
P
export PYTHONPATH=$root/usr/lib/python3/dist-packages
read_all() { "$work/program" "$work/a.mtx"; /usr/bin/python3 "$work/load.py" "$work/a.mtx"; }
expect "CHOLMOD: status 0, 2.5 1.5 4
Eigen: 1, 2.5 1.5 4
GSL: 1, 2.5 1.5 4
SciPy: could not convert string to float: b'2.5D+01'" read_all
