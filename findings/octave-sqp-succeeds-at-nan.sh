#!/usr/bin/env bash
# Octave 7.3 sqp: normal termination (info 101) at a point where the objective is NaN.
#
# Guess before the run: a trial point without a value is refused by the line search; fminunc, fminsearch and fsolve do so.
# Seen: on p - log p from 10, without a value for p <= 0, sqp ends after 8 calls at p = -15 with objective NaN and info 101,
# which its help calls normal termination. fminunc ends at 1 (info 3). With bounds, sqp takes differences outside them, by
# 1.5e-8. Test the objective of the returned point, or return 1e10 where the model has no value: then it ends at 1.
. "$(dirname "$0")/packages.sh"
debian octave=7.3.0-2 octave-common=7.3.0-2
export OCTAVE_HOME=$root/usr OCTAVE_EXEC_HOME=$root/usr HOME=$work
cat >"$work/run.m" <<'M'
1;
function y = f(p, missing) if p <= 0, y = missing; else y = p - log(p); end, end
[x, v, info] = sqp(10, @(p) f(p, NaN)); printf("sqp: value %g, info %d\n", v, info);
[x, v, info] = fminunc(@(p) f(p, NaN), 10); printf("fminunc: %.3f, info %d\n", x, info);
[x, v, info] = sqp(10, @(p) f(p, 1e10)); printf("sqp with 1e10: %.3f, info %d\n", x, info);
global outside = 0;
function y = g(x)
  global outside
  outside += any(x > [0.5; 2]);
  y = 100 * (x(2) - x(1)^2)^2 + (1 - x(1))^2;
end
x = sqp([-1.2; 1], @g, [], [], [-2; -2], [0.5; 2]); printf("sqp with bounds: %.3f, calls outside %d\n", x(1), outside);
M
expect 'sqp: value NaN, info 101
fminunc: 1.000, info 3
sqp with 1e10: 1.000, info 104
sqp with bounds: 0.500, calls outside 3' octave-cli -q --norc "$work/run.m"
