#!/usr/bin/env bash
# fityk 1.3.2: data without errors are weighted by 1/max(y, 1), so a fitted rate changes with the units of y.
#
# Guess before the run: a column of data without errors is fitted without weights, so that y in other units gives the same
# rate k of a exp(-k x), and 100 times the a.
# Seen: cfityk takes sqrt(y) as the standard deviation where it exceeds 1, and 1 elsewhere, as if y were counts. Ten data
# from 0.16 to 1 are fitted without weights, k = 0.2053; in other units, where all exceed 1, k is 0.2069. A line says
# "Set as sqrt(y)". `set default_sigma = one`, or a third column of errors, ends it.
. "$(dirname "$0")/packages.sh"
debian fityk=1.3.2-2+b2
fit() {  # factor of y
  printf '%s\n' 1.003 0.836 0.652 0.565 0.431 0.369 0.290 0.248 0.161 0.184 |
    awk -v factor="$1" '{ print NR - 1, $1 * factor }' >"$work/y.dat"
  cat >"$work/fit.fit" <<S
@0 < '$work/y.dat'
define Decay(a=$1, k=0.3) = a*exp(-k*x)
F = Decay(~$1, ~0.3)
fit
print \$_2
S
  printf 'y times %s: k = %.4f\n' "$1" "$(cfityk -n -q "$work/fit.fit" </dev/null | grep -E '^[0-9.]+$' | tail -n 1)"
}
fits() { for factor in 0.01 1 10 1000; do fit "$factor"; done; }
expect "$(cat <<'S'
y times 0.01: k = 0.2053
y times 1: k = 0.2053
y times 10: k = 0.2069
y times 1000: k = 0.2069
S
)" fits
