#!/usr/bin/env bash
# GDL 1.0.1: deviations by poly_fit and gaussfit do not follow the units of y; linfit's do.
#
# Guess before the run: without measure_errors, all three scale the deviations by the residuals, so
# that linfit and poly_fit give one answer for a straight line, and y in units of 1e-3 has
# deviations that are 1,000 times as large.
# Seen: the slope is 2.0013 with a deviation of 0.0115 by linfit and 0.1101 by poly_fit, which takes
# each datum's deviation as 1. With y in units of 1e-3 linfit says 2001.3 and 11.5, poly_fit 2001.3
# and 0.1101, gaussfit a height of 5003.5 and 0.75. Multiply them by sqrt(chisq / (n - p)), or pass
# measure_errors. And poly_fit is iterative: of third degree over 5000 to 5090, its sum of squares
# is 6.6 times the least one, with status 1; center the abscissa.
. "$(dirname "$0")/packages.sh"
debian gnudatalanguage=1.0.1-4+b5 gdl-mpfit=1.85+2017.01.03-4
export GDL_PATH="+$root/usr/share/gnudatalanguage/lib" GDL_STARTUP= HOME=$work
cat >"$work/run.pro" <<'G'
pro run
  i = dindgen(10)
  noise = [.03d, -.11, .08, .15, -.02, -.14, .06, .01, -.09, .12]
  foreach unit, [1d, 1d3] do begin
    y = unit * (1 + 2 * i + noise)
    c = linfit(i, y, sigma=s, /double)
    print, 'linfit', c[1], s[1], format='(a, f12.4, f10.4)'
    c = poly_fit(i, y, 1, sigma=s, /double)
    print, 'poly_fit', c[1], s[1], format='(a, f12.4, f10.4)'
    y = unit * (5 * exp(-.5d * ((i - 4) / 1.5d)^2) + noise)
    f = gaussfit(i, y, c, nterms=3, sigma=s)
    print, 'gaussfit', c[0], s[0], format='(a, f12.4, f10.4)'
  endforeach
  y = 1d + 2 * i + .1 * i^2 + .01 * i^3 + noise
  c = poly_fit(5000 + 10 * i, y, 3, yfit=f, status=status, /double)
  c = poly_fit(i - 4.5d, y, 3, yfit=best, /double)
  print, 'poly_fit from 5000: ratio', total((y - f)^2) / total((y - best)^2), ', status', status, format='(a, f6.1, a, i2)'
end
G
run() { cd "$work" && gdl -quiet -e run </dev/null 2>/dev/null | grep fit; }
expect 'linfit      2.0013    0.0115
poly_fit      2.0013    0.1101
gaussfit      5.0035    0.7500
linfit   2001.2727   11.4915
poly_fit   2001.2727    0.1101
gaussfit   5003.5134    0.7500
poly_fit from 5000: ratio   6.6, status 1' run
