#!/usr/bin/env bash
# Eigen 3.4.0 loadMarket: a symmetric file of Matrix Market gives one triangle, an array file an empty matrix, with success.
#
# Guess before the run: symmetric and skew-symmetric files are expanded, as SciPy's mmread and R's readMM do; another format
# than `coordinate` returns false.
# Seen: of the 5 entries of a symmetric matrix 4 are there, of a skew-symmetric one 1 of 2, and x = A b is wrong without a
# word; a dense (`array`) file is true and 2 x 2 without entries, with lines on standard error. getMarketHeader names the
# symmetry: ask it and use selfadjointView<Lower>.
. "$(dirname "$0")/packages.sh"
debian libeigen3-dev=3.4.0-4
cat >"$work/load.cpp" <<'C'
#include <cstdio>
#include <fstream>
#include <unsupported/Eigen/SparseExtra>
void load(const char* name, const char* text) {
  std::ofstream("m.mtx") << text;
  Eigen::SparseMatrix<double> a;
  const bool good = Eigen::loadMarket(a, "m.mtx");
  std::printf("%s: %d, %dx%d, %d entries, sum %g\n", name, good, int(a.rows()), int(a.cols()), int(a.nonZeros()), a.sum());
}
int main() {
  load("symmetric", "%%MatrixMarket matrix coordinate real symmetric\n3 3 4\n1 1 2\n2 1 -1\n2 2 2\n3 3 1\n");
  load("skew", "%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 5\n");
  load("general", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 3.5\n2 2 7\n");
  load("array", "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n");
}
C
compile "$work/load.cpp"
cd "$work"
expect 'symmetric: 1, 3x3, 4 entries, sum 4
skew: 1, 2x2, 1 entries, sum 5
general: 1, 2x2, 2 entries, sum 10.5
array: 1, 2x2, 0 entries, sum 0' sh -c "'$work/program' 2>/dev/null"
