#!/usr/bin/env bash
# One MPS file, two problems: glpk 5.0 and lp_solve 5.5.2 add a constant that Clp 1.17.6 takes away.
#
# Guess before the run: the right-hand side of the objective's row is a constant with one sign in all
# readers, and an upper bound below 0 without a lower one is read alike.
# Seen: x + 2 y with x + y >= 3 and 10 on the right of the objective: 13 by glpsol and lp_solve, -7 by
# clp, each of them optimal. With x <= -2, x + y >= -9 and no lower bound given, clp takes minus
# infinity for the lower one and finds -9; for glpsol and lp_solve it is 0, and there is no solution.
# Write both bounds of each unknown, and leave constants out.
. "$(dirname "$0")/packages.sh"
debian glpk-utils=5.0-1 lp-solve=5.5.2.5-2 coinor-clp=1.17.6-3
mps() {  # NAME RIGHT-HAND-SIDES FURTHER LINES...
  local name=$1
  shift
  printf '%s\n' 'NAME          T' ROWS ' N  COST' ' G  R1' COLUMNS \
    '    X         COST         1.0   R1           1.0' '    Y         COST         2.0   R1           1.0' RHS "$@" \
    ENDATA >"$work/$name.mps"
}
mps constant '    RHS       COST        10.0   R1           3.0'
mps bound '    RHS       R1          -9.0' BOUNDS ' UP BND       X           -2.0'
mps plain '    RHS       R1           3.0'
run() {
  local name value
  for name in plain constant bound; do
    glpsol --freemps "$work/$name.mps" -o "$work/out" >/dev/null 2>&1
    printf '%s: glpsol %s, ' "$name" "$(awk '/^Status/ { s = $2 } /^Objective/ { v = $4 } END { print (s == "OPTIMAL" ? v : "none") }' "$work/out")"
    value=$(lp_solve -S3 -fmps "$work/$name.mps" 2>/dev/null | awk '/^Value of objective/ { print $NF + 0 }')
    printf 'lp_solve %s, ' "${value:-none}"
    value=$(clp "$work/$name.mps" -solve 2>/dev/null | awk '/^Optimal objective/ { print $3 }')
    echo "clp ${value:-none}"
  done
}
expect 'plain: glpsol 3, lp_solve 3, clp 3
constant: glpsol 13, lp_solve 13, clp -7
bound: glpsol none, lp_solve none, clp -9' run
