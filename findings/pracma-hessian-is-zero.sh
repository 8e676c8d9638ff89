#!/usr/bin/env bash
# R package pracma 2.4.2: hessian() is 0 where x is 1e6 or more, so standard deviations of such an unknown are infinite.
#
# Guess before the run: steps are relative to x, so the Hessian of x^2 is 2 at every x.
# Seen: its step is absolute (eps^(1/4) = 1.2e-4): from 1e6 on the second difference of x^2 rounds to 0. grad() has an absolute
# step as well, and is 4e-6 off at 1e6 and 4e-3 off at 1e9. numDeriv's hessian is right at all three.
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2 r-cran-pracma=2.4.2-1 r-cran-numderiv=2016.8-1.1-3
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share R_LIBS=$root/usr/lib/R/site-library:/usr/lib/R/site-library
cat >"$work/run.R" <<'R'
f <- function(x) x^2
for (x in c(1, 1e6, 1e9))
  cat(sprintf("x = %g: pracma %.3f, numDeriv %.3f; gradient %.6f\n", x, pracma::hessian(f, x), numDeriv::hessian(f, x),
              pracma::grad(f, x) / (2 * x)))
R
expect 'x = 1: pracma 2.000, numDeriv 2.000; gradient 1.000000
x = 1e+06: pracma 0.000, numDeriv 2.000; gradient 1.000004
x = 1e+09: pracma 0.000, numDeriv 2.000; gradient 1.004053' "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
