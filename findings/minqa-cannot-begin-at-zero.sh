#!/usr/bin/env bash
# R package minqa 1.2.5: bobyqa and newuoa refuse a start of zeros, with a message about a radius that the user did not set.
#
# Guess before the run: a start of zeros is like any other, as it is for optim and for nloptr's bobyqa.
# Seen: the first radius is the smaller of 0.95 and 0.2 of the largest |x|, so at zero both radii are 0, and the check of
# the control list fails. A start of 1e-3 beside a zero begins with a radius of 2e-4. Pass control = list(rhobeg = ...).
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2 r-cran-minqa=1.2.5-1
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share R_LIBS=$root/usr/lib/R/site-library:/usr/lib/R/site-library
cat >"$work/run.R" <<'R'
f <- function(x) 100 * (x[2] - x[1]^2)^2 + (1 - x[1])^2
say <- function(name, method, ...) {
  found <- try(method(c(0, 0), f, ...), silent = TRUE)
  failed <- inherits(found, "try-error")
  cat(name, if (failed) conditionMessage(attr(found, "condition")) else if (found$fval < 1e-8) "solved", "\n")
}
say("bobyqa:", minqa::bobyqa)
say("newuoa:", minqa::newuoa)
say("bobyqa with rhobeg:", minqa::bobyqa, control = list(rhobeg = 0.1, rhoend = 1e-8))
R
expect 'bobyqa: 0 < ctrl$rhoend is not TRUE 
newuoa: 0 < ctrl$rhoend is not TRUE 
bobyqa with rhobeg: solved ' "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
