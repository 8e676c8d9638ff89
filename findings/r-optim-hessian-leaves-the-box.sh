#!/usr/bin/env bash
# R 4.2.2 optim: method L-BFGS-B with hessian = TRUE calls the function outside the bounds.
#
# Guess before the run: the differences for the Hessian stay within lower and upper, as those for the gradient do.
# Seen: on Rosenbrock's function with x1 <= 0.5 the fit makes no call outside; its Hessian at x1 = 0.5 makes five, by up to
# 0.002, since ndeps = 1e-3 is added on both sides. Where the model has no value beyond a bound, optim
# ends with an error, and the fit that was good is lost. Fit without it, and compute the Hessian at a point inside.
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share
cat >"$work/run.R" <<'R'
lower <- c(-2, -2)
upper <- c(0.5, 2)
fit <- function(hessian, missing) {
  outside <- 0
  by <- 0
  f <- function(x) {
    if (any(x < lower | x > upper)) {
      outside <<- outside + 1
      by <<- max(by, x - upper, lower - x)
      if (missing) return(NaN)
    }
    100 * (x[2] - x[1]^2)^2 + (1 - x[1])^2
  }
  found <- try(optim(c(-1.2, 1), f, method = "L-BFGS-B", lower = lower, upper = upper, hessian = hessian), silent = TRUE)
  failed <- inherits(found, "try-error")
  cat("outside", outside, "by", by, if (failed) conditionMessage(attr(found, "condition")) else found$value, "\n")
}
fit(FALSE, TRUE)
fit(TRUE, FALSE)
fit(TRUE, TRUE)
R
expect 'outside 0 by 0 0.25 
outside 5 by 0.002 0.25 
outside 1 by 0.002 non-finite finite-difference value [1] ' "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
