#!/usr/bin/env bash
# gnuplot 5.4.4: a model that has no real value at a trial point is fitted by the real part of its complex value.
#
# Guess before the run: log p at p <= 0 is undefined, so `fit` raises lambda and ends at p = 1, or stops with an error.
# Seen: gnuplot's log of a negative number is complex; the fit takes its real part, log|p|, and ends at p = -1 with a sum of
# squares of 0 and no word. sqrt does the same: its real part, 0, is a plateau. A bound needs a transformed parameter.
. "$(dirname "$0")/packages.sh"
debian gnuplot-nox=5.4.4+dfsg1-2+b2
cat >"$work/fit.gp" <<'G'
set fit quiet logfile '/dev/null'
set print '-'
$zero << EOD
0 0
1 0
2 0
EOD
p = 10.
fit log(p) + 0*x $zero using 1:2 via p
print sprintf("log p: p = %.6g, sum of squares %.3g", p, FIT_WSSR)
p = 10.
fit log(p) + 0*x $zero using 1:2:(1) yerrors via p
print sprintf("with errors: p = %.6g, sum of squares %.3g", p, FIT_WSSR)
print "log(-5) = ", log(-5)
G
expect 'log p: p = -1, sum of squares 0
with errors: p = -1, sum of squares 0
log(-5) =  {1.6094379124341, 3.14159265358979}' gnuplot "$work/fit.gp"
