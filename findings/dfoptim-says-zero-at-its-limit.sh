#!/usr/bin/env bash
# R's dfoptim 2020.10-1: hjkb's code is 0 at a limit met exactly; mads' code is a mesh size.
#
# Guess before the run: convergence is 0 where a method has converged, as in optim, and 1 at its
# limit; each returns the best point it has seen, and in other units the same fit.
# Seen: on Rosenbrock's function with x1 <= 0.5, hjkb with maxfeval = 50 ends at 4.84, where the
# least is 0.25, with code 0: a limit that is met exactly counts as success, at 22, 40 and 50; at 51
# it makes 59 calls, with code 1. mads ends at 1.27, or after one call at its start, 70.9, and its
# convergence is the size of its last mesh, 6e-7. nmk fits a decay whose unknowns are near 1; with
# both in units of 1e-3 it ends after 13 calls, with code 2, and returns 3.17, where it has seen
# 1.55 and the least is 0.00087. Compare the value with that of a second start.
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2 r-cran-dfoptim=2020.10-1-1
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share R_LIBS=$root/usr/lib/R/site-library:/usr/lib/R/site-library
cat >"$work/run.R" <<'R'
library(dfoptim)
calls <- 0
least <- Inf
kept <- function(value) { calls <<- calls + 1; least <<- min(least, value); value }
rosenbrock <- function(x) kept(100 * (x[2] - x[1]^2)^2 + (1 - x[1])^2)
t <- 0:9
y <- 2 * exp(-0.3 * t) + c(3, -11, 8, 15, -2, -14, 6, 1, -9, 12) / 1000
say <- function(name, method, ...) {
  calls <<- 0
  least <<- Inf
  set.seed(1)
  found <- suppressWarnings(method(...))
  cat(sprintf("%s: %d calls, %.3g, least seen %.3g, convergence %.1g\n", name, calls, found$value, least, found$convergence))
}
low <- c(-2, -2)
high <- c(0.5, 2)
for (limit in c(22, 40, 50, 51, 1000))
  say(paste("hjkb", limit), hjkb, c(-1.2, 1), rosenbrock, low, high, control = list(maxfeval = limit))
for (start in list(c(-1.2, 1), c(0.4, 1)))
  say("mads", mads, start, rosenbrock, lower = low, upper = high, control = list(trace = FALSE))
for (unit in c(1, 1000))
  say(paste("nmk, unit", 1 / unit), nmk, c(unit, unit), function(x) kept(sum((x[1] / unit * exp(-x[2] / unit * t) - y)^2)))
R
expect 'hjkb 22: 22 calls, 5.2, least seen 5.2, convergence 0
hjkb 40: 40 calls, 4.84, least seen 4.84, convergence 0
hjkb 50: 50 calls, 4.84, least seen 4.84, convergence 0
hjkb 51: 59 calls, 4.81, least seen 4.81, convergence 1
hjkb 1000: 331 calls, 0.25, least seen 0.25, convergence 0
mads: 404 calls, 1.27, least seen 1.27, convergence 6e-07
mads: 1 calls, 70.9, least seen 70.9, convergence 6e-07
nmk, unit 1: 63 calls, 0.000873, least seen 0.000873, convergence 0
nmk, unit 0.001: 13 calls, 3.17, least seen 1.55, convergence 2' "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
