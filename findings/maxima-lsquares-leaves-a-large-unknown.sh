#!/usr/bin/env bash
# Maxima 5.46.0: lsquares_estimates returns an unknown in other units at its start, without a word.
#
# Guess before the run: L-BFGS finds a exp(-b t) + c to six digits, in any units, or says that it failed.
# Seen: at its default tolerance of 1e-3 the rate is 0.7211 for 0.7181, a tenth of its standard deviation away. With the rate
# in units of 1e-6 the rate stays at its start, 1e6, a is 1.31 for 2.52, and the answer has the same form as a good one.
# And `lbfgs` on (log p)^2 + 0.01 (p - 1)^2 from 10 ends at p = -0.98: the logarithm is complex there, its square has a
# value whose part that is compared is smaller.
. "$(dirname "$0")/packages.sh"
debian maxima=5.46.0-11 maxima-share=5.46.0-11
export MAXIMA_PREFIX=$root/usr
cat >"$work/fit.mac" <<'M'
load(lsquares)$ load(lbfgs)$ fpprintprec: 4$
M: genmatrix(lambda([i, j], if j = 1 then (i-1)*0.25 else
  float(2.5*exp(-0.7*(i-1)*0.25) + 0.5 + 0.05*sin(7*(i-1)))), 21, 2)$
say(name, r) := print("seen", name, map(rhs, r))$
say("rate:", first(lsquares_estimates(M, [x,y], y = a*exp(-b*x) + c, [a,b,c], initial = [1,1,0], iprint = [-1,0])))$
say("rate, tol = 1e-8:", first(lsquares_estimates(M, [x,y], y = a*exp(-b*x) + c, [a,b,c], initial = [1,1,0],
  iprint = [-1,0], tol = 1e-8)))$
say("rate in 1e-6:", first(lsquares_estimates(M, [x,y], y = a*exp(-1e-6*b*x) + c, [a,b,c], initial = [1,1e6,0],
  iprint = [-1,0])))$
say("logarithm:", lbfgs(log(p)^2 + 0.01*(p-1)^2, [p], [10.0], 1e-8, [-1,0]))$
M
expect 'seen rate: [2.523, 0.7211, 0.5161]
seen rate, tol = 1e-8: [2.52, 0.7181, 0.5145]
seen rate in 1e-6: [1.312, 1.0E+6, 0.9501]
seen logarithm: [- 0.9808]' sh -c "maxima --very-quiet -b '$work/fit.mac' 2>&1 | grep '^seen' | sed 's/ *\$//'"
