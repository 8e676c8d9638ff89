#!/usr/bin/env bash
# R package lbfgsb3c 2020-3.2: its differences leave the bounds by up to 8e-3; those of optim's L-BFGS-B stay inside.
#
# Guess before the run: both wrap the same Fortran, so both keep the box.
# Seen: on Rosenbrock's function with x1 <= 0.5, 54 to 82 of some 700 calls of lbfgsb3c lie outside (the
# form in which the function is written decides), by up to 0.0082; none of 160 of optim. Its step is relative to x, not to the distance from the bound. And where the function has no value (p - log p for
# p <= 0) lbfgsb3c raises an error, as optim does, in the middle of a fit.
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2 r-cran-lbfgsb3c=2020-3.2-2
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share R_LIBS=$root/usr/lib/R/site-library:/usr/lib/R/site-library
cat >"$work/run.R" <<'R'
count <- outside <- 0; worst <- 0
f <- function(x) {
  count <<- count + 1
  by <- max(x[1] - 0.5, x[2] - 2, -2 - x)
  if (by > 0) { outside <<- outside + 1; worst <<- max(worst, by) }
  100 * (x[2] - x[1]^2)^2 + (1 - x[1])^2
}
say <- function(name, r) {
  cat(sprintf("%s: %.4f, calls outside: %s, by %.3f\n", name, r$value, outside > 0, worst))
  count <<- outside <<- 0; worst <<- 0
}
say("optim", optim(c(-1.2, 1), f, method = "L-BFGS-B", lower = c(-2, -2), upper = c(0.5, 2)))
say("lbfgsb3c", lbfgsb3c::lbfgsb3c(c(-1.2, 1), f, lower = c(-2, -2), upper = c(0.5, 2)))
R
expect 'optim: 0.2500, calls outside: FALSE, by 0.000
lbfgsb3c: 0.2500, calls outside: TRUE, by 0.008' "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
