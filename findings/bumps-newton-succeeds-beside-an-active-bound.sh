#!/usr/bin/env bash
# bumps 0.9.0: where a bound is active, `newton` says success far from the fit, and deviations ignore the bound.
#
# Guess before the run: a quasi-Newton method of a package whose parameters all have ranges projects onto them, so that
# the free unknown ends at its best value, 5.5; the deviation of the free one is that with the other held, 0.0316.
# Seen: 1 + 2 t with noise, b in [0, 1]. `newton` holds b at 1 and ends at a = 2.205 with `success` and more than twice the
# least chi-square, which `amoeba` and `de` find. All three give a the deviation of the fit without the bound, 0.0588. `lm`,
# the method for such fits, cannot run beside Debian's NumPy at all.
. "$(dirname "$0")/packages.sh"
debian python3-bumps=0.9.0-3 python3-numpy=1:1.24.2-1+deb12u1 python3-scipy=1.10.1-2
cat >"$work/run.py" <<'P'
import numpy as np
from bumps.fitters import fit
from bumps.names import Curve, FitProblem

t = np.arange(10.0)
y = 1 + 2 * t + 0.1 * np.array([0.5, -1, 0.3, 1.2, -0.7, 0.1, -0.4, 0.9, -1.1, 0.2])
for method in ("newton", "amoeba", "de", "lm"):
    model = Curve(lambda x, a=0, b=0: a + b * x, t, y, 0.1, a=0.0, b=0.5)
    model.a.range(-20, 20)
    model.b.range(0, 1)
    problem = FitProblem(model)
    try:
        found = fit(problem, method=method)
    except AttributeError as error:
        print(f"{method}: {str(error).splitlines()[0]}")
        continue
    print(f"{method}: a {found.x[0]:.3f} ± {found.dx[0]:.4f}, b {found.x[1]:.3f}, chi-square "
          f"{problem.chisq():.0f}, success {found.success}")
P
export PYTHONPATH=$root/usr/lib/python3/dist-packages
run() { /usr/bin/python3 "$work/run.py" 2>/dev/null; }
expect "newton: a 2.205 ± 0.0588, b 1.000, chi-square 2383, success True
amoeba: a 5.500 ± 0.0588, b 1.000, chi-square 1026, success True
de: a 5.500 ± 0.0588, b 1.000, chi-square 1026, success True
lm: module 'numpy' has no attribute 'float'." run
