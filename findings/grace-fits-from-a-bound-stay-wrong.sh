#!/usr/bin/env bash
# Grace 5.1.25: a fit whose parameter starts at one of its bounds ends at a wrong point, in the words of a success.
#
# Guess before the run: the bound is clipped or penalized, so that a start on it leads inside, to the least squares.
# Seen: 1 + 2 x with noise, 0 <= a1 <= 5. From a1 = 0.01 to 4.9 the fit is right. From 0, the bound, both parameters end
# near 0; from 5 it jumps across its interval to 0. Each time "Relative error in the sum of squares is at most tol" is
# printed, as beside the right fit, and the correlation coefficient 0.999917, which does not see a wrong slope. 4.9999
# does not lead back, either. A start belongs well inside the bounds, and the sum of squares is to be read.
. "$(dirname "$0")/packages.sh"
debian grace=1:5.1.25-13 fonts-urw-base35=20200910-7
export GRACE_HOME=$root/usr/share/grace
ln -s "$root/usr/bin/xmgrace" "$work/gracebat"  # its name says that there is no window
sed "s,\"/usr/,\"$root/usr/,; s,-w$,," "$root/usr/sbin/update-grace-fonts" | perl  # without fonts it ends at once
awk 'BEGIN { n = split("0.5 -1 0.3 1.2 -0.7 0.1 -0.4 0.9 -1.1 0.2", e)
  for (i = 0; i < n; i++) print i, 1 + 2 * i + 0.1 * e[i + 1] }' >"$work/line.dat"
fits() {
  local start
  for start in 0.01 2.5 4.9 0 5 4.9999; do
    cat >"$work/fit.bat" <<G
READ XY "$work/line.dat"
fit formula "y = a0 + a1 * x"
fit with 2 parameters
fit prec 0.0001
a0 = 0
a0 constraints off
a1 = $start
a1min = 0
a1max = 5
a1 constraints on
nonlfit(s0, 100)
G
    "$work/gracebat" -nosafe -noprint -batch "$work/fit.bat" >"$work/said" 2>&1
    echo "from a1 = $start: $(awk '/at most tol/ { said = $0 } / = / && NF == 3 && said { value[$1] = $3 }
      /Chi-square/ { chi = $2 } /Correlation/ { r = $3 }
      END { printf "a0 %.3f, a1 %.3f, chi-square %.4g, correlation %s; %s", value["a0"], value["a1"], chi, r, said }' \
      "$work/said")"
  done
}
expect "$(cat <<'S'
from a1 = 0.01: a0 1.012, a1 1.997, chi-square 0.05441, correlation 0.999917; Relative error in the sum of squares is at most tol.
from a1 = 2.5: a0 1.012, a1 1.997, chi-square 0.05441, correlation 0.999917; Relative error in the sum of squares is at most tol.
from a1 = 4.9: a0 1.012, a1 1.997, chi-square 0.05441, correlation 0.999917; Relative error in the sum of squares is at most tol.
from a1 = 0: a0 0.000, a1 0.000, chi-square 1329, correlation 0.999917; Relative error in the sum of squares is at most tol.
from a1 = 5: a0 10.000, a1 0.000, chi-square 329.2, correlation 0.999917; Relative error in the sum of squares is at most tol.
from a1 = 4.9999: a0 9.948, a1 0.000, chi-square 329.2, correlation 0.999917; Relative error in the sum of squares is at most tol.
S
)" fits
