#!/usr/bin/env bash
# iminuit 2.11.2: a limit just beyond the best value makes a "valid" deviation 100 times larger.
#
# Guess before the run: a limit that does not bind leaves the deviation, 0.0110, as it is; near the
# best value it lies between that and the one with the parameter held, so it never grows. `valid`
# and `accurate` tell where that fails.
# Seen: 1 + 2 t with noise, 0 <= b <= limit, best b = 2.00127. With the limit at 2.005 the deviation
# of b is 0.011, at 2.002 0.037, at 2.0015 0.10 and at 2.0013 1.2, more than half of the interval
# from 0 to the limit; with the limit at 2.0, which binds, it is 0.043, at 1.99 0.0054. All of them
# are valid and accurate; those of a stay between 0.032, with b held, and 0.059, free. The fit runs
# in the arc sine of b, whose slope is infinite at a limit. Fit again without the limit, or with b
# fixed on it, for deviations.
. "$(dirname "$0")/packages.sh"
debian python3-iminuit=2.11.2-4 python3-numpy=1:1.24.2-1+deb12u1
cat >"$work/run.py" <<'P'
import numpy
from iminuit import Minuit
from iminuit.cost import LeastSquares

t = numpy.arange(10.0)
noise = numpy.array([0.03, -0.11, 0.08, 0.15, -0.02, -0.14, 0.06, 0.01, -0.09, 0.12])
loss = LeastSquares(t, 1 + 2 * t + noise, 0.1, lambda x, a, b: a + b * x)
for limit in [None, 2.5, 2.005, 2.002, 2.0015, 2.0013, 2.0, 1.99]:
    fit = Minuit(loss, a=0.5, b=1)
    if limit:
        fit.limits["b"] = (0, limit)
    fit.migrad()
    ratio = fit.errors["b"] / 0.01101
    size = "half" if ratio < 0.6 else "once" if ratio < 1.1 else "3 to 6 times" if 3 < ratio < 6 else "over 6 times"
    print(f"limit {limit}: valid {fit.valid}, accurate {fit.accurate}, b {fit.values['b']:.3f}, deviation of b: {size} 0.011")
P
export PYTHONPATH=$root/usr/lib/python3/dist-packages
expect 'limit None: valid True, accurate True, b 2.001, deviation of b: once 0.011
limit 2.5: valid True, accurate True, b 2.001, deviation of b: once 0.011
limit 2.005: valid True, accurate True, b 2.001, deviation of b: once 0.011
limit 2.002: valid True, accurate True, b 2.001, deviation of b: 3 to 6 times 0.011
limit 2.0015: valid True, accurate True, b 2.001, deviation of b: over 6 times 0.011
limit 2.0013: valid True, accurate True, b 2.001, deviation of b: over 6 times 0.011
limit 2.0: valid True, accurate True, b 2.000, deviation of b: 3 to 6 times 0.011
limit 1.99: valid True, accurate True, b 1.990, deviation of b: half 0.011' /usr/bin/python3 "$work/run.py"
