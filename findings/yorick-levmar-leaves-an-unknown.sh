#!/usr/bin/env bash
# Yorick 2.2.04: levmar leaves an unknown in other units at its start, with a deviation of 3e-14.
#
# Guess before the run: Levenberg and Marquardt's method scales its damping by the diagonal, so that a
# decay is fitted in any units; and beside an active bound the free unknown ends at its best value.
# Seen: a exp(-b t) is fitted for b near 1, deviations 0.85 and 0.21. With b in units of 1e-6, b stays
# at its start, with a deviation of 3e-13; with b in units of 1e6, a stays there, with 3e-14: the
# least sum of squares is 0.00087, and these have 2.3 and 1.6, without a word. With b <= 1 in a + b t
# to data of 1 + 2 t the sum is 3.3 times the least one, and the deviations are those without the
# bound. Scale the unknowns, and fit again with the other one fixed.
. "$(dirname "$0")/packages.sh"
debian yorick=2.2.04+dfsg1-12 yorick-data=2.2.04+dfsg1-12
cat >"$work/run.i" <<'Y'
#include "levmar.i"
func decay(t, p) { return p(1) * exp(-p(2) / scale * t); }
func line(t, p) { return p(1) + p(2) * t; }
t = span(0, 9, 10);
y = 2 * exp(-0.3 * t) + [3, -11, 8, 15, -2, -14, 6, 1, -9, 12] / 1000.;
all = [1., 1e6, 1e-6];
for (i = 1; i <= 3; ++i) {
  scale = all(i);
  p = levmar(y, t, decay, [1., scale], v);
  write, format="unit %g: a %.3f, b %.3f, deviations %.2g and %.2g, squares %.3g\n", 1 / scale, p(1), p(2) / scale,
    sqrt(v(1)), sqrt(v(2)) / scale, sum((y - decay(t, p))^2);
}
y = 1 + 2 * t + [5, -10, 3, 12, -7, 1, -4, 9, -11, 2] / 100.;
for (top = 5.; top > 0; top -= 4) {
  p = levmar(y, t, line, [0., 0.5], v, wgt=array(100., 10), amin=[-20., 0.], amax=[20., top]);
  write, format="b <= %g: a %.3f, b %.3f, deviations %.4f and %.4f, squares %.3g\n", top, p(1), p(2), sqrt(v(1)),
    sqrt(v(2)), sum((y - line(t, p))^2);
}
write, format="b = 1, a = 5.5: squares %.3g\n", sum((y - line(t, [5.5, 1.]))^2);
quit;
Y
expect 'unit 1: a 2.000, b 0.300, deviations 0.85 and 0.21, squares 0.000873
unit 1e-06: a 2.378, b 1.000, deviations 0.93 and 3.5e-13, squares 2.32
unit 1e+06: a 1.000, b 0.141, deviations 3.1e-14 and 0.15, squares 1.59
b <= 5: a 1.012, b 1.997, deviations 0.0588 and 0.0110, squares 0.0544
b <= 1: a 1.162, b 1.000, deviations 0.0588 and 0.0110, squares 270
b = 1, a = 5.5: squares 82.1' yorick -batch "$work/run.i"
