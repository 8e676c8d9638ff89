#!/usr/bin/env bash
# R 4.2.2 optim: at its limit, method CG returns the last value with the point before it.
#
# Guess before the run: `value` is fn(par) for every method and limit, as it is for BFGS, L-BFGS-B
# and Nelder-Mead.
# Seen: on Rosenbrock's function with maxit = 1, par is the start, which has 24.2, and value is
# 4.132, that of the best point, which is lost. With maxit = 5 and 100, the default, value is too
# small by 0.006 and 0.014. So is it with a gradient; a Hessian is that of par, too. maxLik 1.5-2
# passes both on as its maximum and estimate. Without a limit in the way the pair agrees. Call the
# function at par before two methods are compared.
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share
cat >"$work/run.R" <<'R'
best <- Inf
f <- function(x) {
  v <- 100 * (x[2] - x[1]^2)^2 + (1 - x[1])^2
  best <<- min(best, v)
  v
}
g <- function(x) c(-400 * x[1] * (x[2] - x[1]^2) - 2 * (1 - x[1]), 200 * (x[2] - x[1]^2))
run <- function(name, method, slope, limit) {
  best <<- Inf
  found <- optim(c(-1.2, 1), f, slope, method = method, control = list(maxit = limit))
  least <- best
  cat(sprintf("%s, maxit %d: value %.4g, at par %.4g, least seen %s, code %d\n", name, limit,
              found$value, f(found$par), if (least == found$value) "the value" else "another",
              found$convergence))
}
for (limit in c(1, 5, 100)) run("CG", "CG", NULL, limit)
for (limit in c(1, 5, 100, 20000)) run("CG with gradient", "CG", g, limit)
for (limit in c(5, 20)) run("BFGS with gradient", "BFGS", g, limit)
R
expect 'CG, maxit 1: value 4.132, at par 24.2, least seen the value, code 1
CG, maxit 5: value 4.101, at par 4.107, least seen the value, code 1
CG, maxit 100: value 3.106, at par 3.121, least seen the value, code 1
CG with gradient, maxit 1: value 4.132, at par 24.2, least seen the value, code 1
CG with gradient, maxit 5: value 4.101, at par 4.107, least seen the value, code 1
CG with gradient, maxit 100: value 3.107, at par 3.121, least seen the value, code 1
CG with gradient, maxit 20000: value 3.674e-12, at par 3.674e-12, least seen the value, code 0
BFGS with gradient, maxit 5: value 2.831, at par 2.831, least seen the value, code 1
BFGS with gradient, maxit 20: value 0.1346, at par 0.1346, least seen the value, code 1' "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
