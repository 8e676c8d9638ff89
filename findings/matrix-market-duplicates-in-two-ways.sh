#!/usr/bin/env bash
# Two Matrix Market entries for one place: SciPy and CHOLMOD add them, ViennaCL and librsb keep one.
#
# Guess before the run: all readers add entries of one place, as finite-element assembly writes them,
# or refuse the file.
# Seen: of 1.5 and 2.25 at (1, 1), SciPy 1.10.1, CHOLMOD 5.12.0 and Eigen 3.4.0 make 3.75; ViennaCL
# 1.7.1, librsb 1.3.0.2 and GSL 2.7.1 keep the last, 2.25, with success. A normal matrix that is put
# together from parts is another matrix there. Add them up before the file is written. And librsb
# reads skew-symmetric files as one triangle.
. "$(dirname "$0")/packages.sh"
debian libviennacl-dev=1.7.1+dfsg1-6 librsb-dev=1.3.0.2+dfsg-4 libgsl-dev=2.7.1+dfsg-5+deb12u1 libgsl27=2.7.1+dfsg-5+deb12u1 \
  libgslcblas0=2.7.1+dfsg-5+deb12u1 \
  libsuitesparse-dev=1:5.12.0+dfsg-2 libcholmod3=1:5.12.0+dfsg-2 libsuitesparseconfig5=1:5.12.0+dfsg-2 \
  libeigen3-dev=3.4.0-4 python3-scipy=1.10.1-2 python3-numpy=1:1.24.2-1+deb12u1
printf '%s\n' '%%MatrixMarket matrix coordinate real general' '2 2 3' '1 1 1.5' '1 1 2.25' '2 2 7' >"$work/two.mtx"
printf '%s\n' '%%MatrixMarket matrix coordinate real skew-symmetric' '2 2 1' '2 1 2.25' >"$work/skew.mtx"
cat >"$work/run.cpp" <<'C'
#include <cstdio>
#include <gsl/gsl_spmatrix.h>
#include <map>
#include <rsb.h>
#include <suitesparse/cholmod.h>
#include <unsupported/Eigen/SparseExtra>
#include <vector>
#include <viennacl/compressed_matrix.hpp>
#include <viennacl/io/matrix_market.hpp>

static void librsb(const char *name, const char *file) {
  rsb_err_t error = 0;
  const double one = 1, none = 0, x[2] = {1, 0};
  double y[2] = {0, 0}, z[2] = {0, 0};
  struct rsb_mtx_t *matrix = rsb_file_mtx_load(file, 0, RSB_NUMERICAL_TYPE_DOUBLE, &error);
  rsb_spmv(RSB_TRANSPOSITION_N, &one, matrix, x, 1, &none, y, 1);
  rsb_spmv(RSB_TRANSPOSITION_T, &one, matrix, x, 1, &none, z, 1);
  std::printf("%s: first column %g %g, first row %g %g, error %d\n", name, y[0], y[1], z[0], z[1], (int)error);
}
int main(int, char **file) {
  std::vector<std::map<unsigned, double>> rows;
  viennacl::io::read_matrix_market_file(rows, file[1]);
  std::printf("ViennaCL: %g\n", rows[0][0]);
  rsb_lib_init(RSB_NULL_INIT_OPTIONS);
  librsb("librsb", file[1]);
  librsb("librsb, skew-symmetric", file[2]);
  std::FILE *opened = std::fopen(file[1], "r");
  std::printf("GSL: %g\n", gsl_spmatrix_get(gsl_spmatrix_fscanf(opened), 0, 0));
  std::rewind(opened);
  cholmod_common common;
  cholmod_start(&common);
  cholmod_sparse *matrix = cholmod_read_sparse(opened, &common);
  std::printf("CHOLMOD: %g\n", static_cast<double *>(matrix->x)[0]);
  Eigen::SparseMatrix<double> sparse;
  Eigen::loadMarket(sparse, file[1]);
  std::printf("Eigen: %g\n", sparse.coeff(0, 0));
}
C
compile "$work/run.cpp" -std=c++17 -lrsb -lgsl -lgslcblas -lcholmod -Wl,--unresolved-symbols=ignore-in-shared-libs
export PYTHONPATH=$root/usr/lib/python3/dist-packages
run() {
  "$work/program" "$work/two.mtx" "$work/skew.mtx" 2>/dev/null
  /usr/bin/python3 -c 'import scipy.io, sys; print("SciPy:", scipy.io.mmread(sys.argv[1]).toarray()[0, 0])' "$work/two.mtx"
}
expect 'ViennaCL: 2.25
librsb: first column 2.25 0, first row 2.25 0, error 0
librsb, skew-symmetric: first column 0 2.25, first row 0 0, error 0
GSL: 2.25
CHOLMOD: 3.75
Eigen: 3.75
SciPy: 3.75' run
