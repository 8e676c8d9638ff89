#!/usr/bin/env bash
# Scilab 6.1.1 optim: at its limit f is not that of x; with bounds, its counts are the limits.
#
# Guess before the run: at the limit optim returns the best point so far with its value, and its
# fifth and sixth results count iterations and calls, with bounds as without.
# Seen: on Rosenbrock's function by "qn", after 20 calls, f is 1.181, that of the last trial, while
# x is the best point, with 0.569; after 5 calls f is 3.417, that of the best point, while x is
# another one, with 4.226. Neither half can be trusted: call the function at x. With bounds value
# and point agree, but after 36 calls their number is given as the limit, 100 by default, and that
# of the iterations as theirs. "gc" and "nd" return pairs.
. "$(dirname "$0")/packages.sh"
debian scilab-minimal-bin=6.1.1+dfsg2-6 scilab-data=6.1.1+dfsg2-6
export SCI=$root/usr/share/scilab HOME=$work
cat >"$work/run.sce" <<'S'
mode(-1);
global calls best
function [f, g, ind] = rosenbrock(x, ind)
  global calls best
  a = x(2) - x(1)^2; f = 100 * a^2 + (1 - x(1))^2; g = [-400 * a * x(1) - 2 * (1 - x(1)); 200 * a];
  calls = calls + 1; best = min(best, f);
endfunction
for method = ["qn" "gc" "nd"]
  for limit = [5 20 30]
    calls = 0; best = %inf;
    [f, x] = optim(rosenbrock, [-1.2; 1], method, "ar", limit, 1000);
    least = best;
    mprintf("%s, limit %d: f %.3f, at x %.3f, least %.3f\n", method, limit, f, rosenbrock(x, 4), least);
  end
end
for limit = [50 100 200]
  calls = 0;
  [f, x, g, work, iterations, counted] = optim(rosenbrock, "b", [-2; -2], [0.5; 2], [-1.2; 1], "qn", "ar", limit, 1000);
  mprintf("bounds, limit %d: f %.3f, %d calls, counted %d, iterations %d\n", limit, f, calls, counted, iterations);
end
exit
S
run() { scilab-cli-bin -nb -f "$work/run.sce" </dev/null; }
expect 'qn, limit 5: f 3.417, at x 4.226, least 3.417
qn, limit 20: f 1.181, at x 0.569, least 0.569
qn, limit 30: f 0.061, at x 0.123, least 0.061
gc, limit 5: f 4.133, at x 4.133, least 4.133
gc, limit 20: f 1.354, at x 1.354, least 1.354
gc, limit 30: f 0.306, at x 0.306, least 0.306
nd, limit 5: f 4.199, at x 4.199, least 4.199
nd, limit 20: f 3.663, at x 3.663, least 3.663
nd, limit 30: f 2.426, at x 2.426, least 2.426
bounds, limit 50: f 0.250, 36 calls, counted 50, iterations 1000
bounds, limit 100: f 0.250, 36 calls, counted 100, iterations 1000
bounds, limit 200: f 0.250, 36 calls, counted 200, iterations 1000' run
