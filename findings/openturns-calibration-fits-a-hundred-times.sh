#!/usr/bin/env bash
# OpenTURNS 1.20: NonLinearLeastSquaresCalibration fits a hundred more times by default: 2,445 calls of a model for 95.
#
# Guess before the run: a fit of three parameters to ten data takes some tens of calls of the model for each datum, since
# the solver behind it is Ceres' Levenberg-Marquardt.
# Seen: the default bootstrap size is 100, and each of the 100 resampled data sets is fitted, too, for the distribution of
# the parameters. With bootstrap size 0 the same parameters come of 95 calls, and the distribution is normal. They are the
# least-squares parameters to five digits. For a slow model, set the size to 0 first.
. "$(dirname "$0")/packages.sh"
debian python3-openturns=1.20-9
cat >"$work/run.py" <<'P'
import math

import openturns as ot

TIMES = [[float(i)] for i in range(10)]
DATA = [[v] for v in (2.51, 2.04, 1.67, 1.36, 1.15, 0.92, 0.79, 0.61, 0.55, 0.46)]
calls = 0


def decay(at):
    global calls
    calls += 1
    t, a, k, c = at
    return [a * math.exp(-k * t) + c]


model = ot.ParametricFunction(ot.PythonFunction(4, 1, decay), [1, 2, 3], [1.0, 0.5, 0.0])
for size in (None, 0):
    calls = 0
    fit = ot.NonLinearLeastSquaresCalibration(model, ot.Sample(TIMES), ot.Sample(DATA), [1.0, 0.5, 0.0])
    if size is not None:
        fit.setBootstrapSize(size)
    fit.run()
    found = ", ".join(f"{each:.4f}" for each in fit.getResult().getParameterMAP())
    print(f"bootstrap size {fit.getBootstrapSize()}: {calls / len(TIMES):.0f} calls, parameters {found}")
P
expect "$(cat <<'S'
bootstrap size 100: 2445 calls, parameters 2.4008, 0.2139, 0.1060
bootstrap size 0: 95 calls, parameters 2.4008, 0.2139, 0.1060
S
)" env PYTHONPATH="$root/usr/lib/python3/dist-packages" /usr/bin/python3 "$work/run.py"
