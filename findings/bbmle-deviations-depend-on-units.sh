#!/usr/bin/env bash
# R's bbmle 1.0.25: with a rate in other units, a deviation is 6e7 times too small, without a word.
#
# Guess before the run: deviations are roots of the diagonal of the inverse Hessian, which follow
# the unit of each unknown as far as the Hessian does; where it cannot be inverted there is a
# warning or NA.
# Seen: 1 + 2 t with noise, deviations 0.0588 and 0.0110. With the slope in units of 1000, where it
# is 0.002, mle2 finds the same line and the exact Hessian, and says 9.4e-10 for the intercept and
# half of the slope's deviation; in units of 1e-6, half of the intercept's, and 1.4e-13 for 0.0110.
# R's solve() of the same Hessian is right for all. mle2's inverse is a pseudo-inverse, which drops
# the smaller direction of a matrix that is only badly scaled. Scale the unknowns, or invert
# fit@details$hessian.
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2 r-cran-bbmle=1.0.25-2
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share R_LIBS=$root/usr/lib/R/site-library:/usr/lib/R/site-library
cat >"$work/run.R" <<'R'
suppressMessages(library(bbmle))
t <- 0:9
y <- 1 + 2 * t + 0.1 * c(0.5, -1, 0.3, 1.2, -0.7, 0.1, -0.4, 0.9, -1.1, 0.2)
for (unit in c(1, 100, 1e6, 0.01, 1e-3)) {
  warned <- "no warning"
  fit <- withCallingHandlers(
    mle2(function(a, b) -sum(dnorm(y, a + b / unit * t, 0.1, log = TRUE)), start = list(a = 0, b = unit / 2)),
    warning = function(w) warned <<- conditionMessage(w))
  said <- stdEr(fit) / c(1, unit)
  solved <- sqrt(diag(solve(fit@details$hessian, tol = 0))) / c(1, unit)
  cat(sprintf("unit %g: %.2f + %.2f t, deviations %.2g and %.2g, by solve %.4f and %.4f, %s\n", 1 / unit,
              coef(fit)[1], coef(fit)[2] / unit, said[1], said[2], solved[1], solved[2], warned))
}
R
expect 'unit 1: 1.01 + 2.00 t, deviations 0.059 and 0.011, by solve 0.0588 and 0.0110, no warning
unit 0.01: 1.01 + 2.00 t, deviations 0.059 and 0.011, by solve 0.0588 and 0.0110, no warning
unit 1e-06: 1.01 + 2.00 t, deviations 0.032 and 1.4e-13, by solve 0.0588 and 0.0110, no warning
unit 100: 1.01 + 2.00 t, deviations 0.059 and 0.011, by solve 0.0588 and 0.0110, no warning
unit 1000: 1.01 + 2.00 t, deviations 9.4e-10 and 0.0059, by solve 0.0588 and 0.0110, no warning' "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
