#!/usr/bin/env bash
# R's rgenoud 5.9-0.3: Domains bound the first generation only; the default leaves them, and "partial" enforcement nine times as dear.
#
# Guess before the run: Domains, a matrix of lower and upper bounds, keep all calls and the result within.
# Seen: on Rosenbrock's function with x1 <= 0.5, genoud ends at (0.9998, 0.9996), 4,091 of 7,104 calls outside. With
# boundary.enforcement = 1, which lets calls leave the box on the way, 61,388 calls for the same answer as with 2 in 6,777.
# Only boundary.enforcement = 2 makes no call outside. Set it where the model has no value beyond its bounds.
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2 r-cran-rgenoud=5.9-0.3-1
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share R_LIBS=$root/usr/lib/R/site-library:/usr/lib/R/site-library
cat >"$work/run.R" <<'R'
suppressMessages(library(rgenoud))
calls <- outside <- 0
valley <- function(x) {
  calls <<- calls + 1
  if (x[1] < -2 || x[1] > 0.5 || x[2] < -2 || x[2] > 2) outside <<- outside + 1
  100 * (x[2] - x[1]^2)^2 + (1 - x[1])^2
}
box <- matrix(c(-2, -2, 0.5, 2), 2)
for (enforcement in 0:2) {
  calls <- outside <- 0
  found <- suppressWarnings(genoud(valley, 2, Domains = box, print.level = 0, boundary.enforcement = enforcement,
                                   unif.seed = 1, int.seed = 1, starting.values = c(-1, 1)))
  cat(sprintf("enforcement %d: x1 = %.4f, value %.2g, %d calls, %d outside\n", enforcement, found$par[1], found$value,
              calls, outside))
}
R
expect "$(cat <<'S'
enforcement 0: x1 = 0.9998, value 3.8e-08, 7104 calls, 4091 outside
enforcement 1: x1 = 0.5000, value 0.25, 61388 calls, 18056 outside
enforcement 2: x1 = 0.5000, value 0.25, 6777 calls, 0 outside
S
)" "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
