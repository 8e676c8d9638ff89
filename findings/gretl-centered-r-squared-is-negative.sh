#!/usr/bin/env bash
# gretl 2022c: after nls, "Centered R-squared" is negative where the model explains 99.9 %, and the "Uncentered" one is the centered one.
#
# Guess before the run: for residuals with the sum of squares S, uncentered is 1 - S / sum y^2, centered 1 - S / sum (y - mean)^2.
# Seen: the first of these numbers is printed nowhere; the second one is printed as "Uncentered R-squared", and beside it
# stands a "Centered R-squared" of -0.0075 for a fit of a decay whose sum of squares is 0.1 % of that about the mean. The
# parameters, their errors and S are right. Compute R-squared from $uhat.
. "$(dirname "$0")/packages.sh"
debian gretl=2022c-1
cat >"$work/fit.inp" <<'X'
nulldata 10
series x = index - 1
series y = {2.51, 2.04, 1.67, 1.36, 1.15, 0.92, 0.79, 0.61, 0.55, 0.46}'
scalar a = 2
scalar k = 0.2
nls y = a * exp(-k * x)
  params a k
end nls
scalar left = sum($uhat^2)
printf "own uncentered %.6f\n", 1 - left / sum(y^2)
printf "own centered %.6f\n", 1 - left / sum((y - mean(y))^2)
X
fit() {
  (cd "$work" && GRETLHOME=$root/usr/share/gretl gretlcli -b fit.inp 2>/dev/null) |
    grep -E '^Uncentered|^Log|^own|Centered' | grep -oE '(Unc|C)entered R-squared +[-0-9.]+|^own .*' | tr -s ' '
}
expect "$(cat <<'S'
Uncentered R-squared 0.998951
Centered R-squared -0.007494
own uncentered 0.999763
own centered 0.998951
S
)" fit
