#!/usr/bin/env bash
# astropy 5.2.1: three of six fitters stay on a bound that the fit does not need, without a warning.
#
# Guess before the run: a bound beyond the best value changes nothing, from any start within bounds.
# Seen: 1 + 2 t with noise, best b = 1.99733. From b = 5, its upper bound, LevMarLSQFitter, the one of
# most examples, LMLSQFitter and SimplexLSQFitter end at b = 5 with 744, where the least sum of squares
# is 0.054. With the bound at 2.005 SimplexLSQFitter ends on it from 0.5, well inside, too. A trial
# beyond a bound is clipped to it, so that the model is constant there. None of them warns; LMLSQFitter
# gives deviations. TRFLSQFitter, DogBoxLSQFitter and SLSQPLSQFitter are right from each start. Take
# TRFLSQFitter where there are bounds.
. "$(dirname "$0")/packages.sh"
debian python3-astropy=5.2.1-2+deb12u1 python3-scipy=1.10.1-2 python3-numpy=1:1.24.2-1+deb12u1
cat >"$work/run.py" <<'P'
import warnings

import numpy as np
from astropy.modeling import custom_model, fitting

t = np.arange(10.0)
y = 1 + 2 * t + 0.1 * np.array([0.5, -1, 0.3, 1.2, -0.7, 0.1, -0.4, 0.9, -1.1, 0.2])


@custom_model
def line(t, a=0.0, b=0.5):
    return a + b * t


for name in ("LevMarLSQFitter", "LMLSQFitter", "SimplexLSQFitter", "TRFLSQFitter", "DogBoxLSQFitter", "SLSQPLSQFitter"):
    ends = []
    for top, start in ((5, 0.5), (5, 5), (2.005, 0.5)):
        model = line(0.0, start)
        model.b.bounds = (0, top)
        with warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always")
            choice = {"verblevel": 0} if name == "SLSQPLSQFitter" else {}
            found = getattr(fitting, name)()(model, t, y, **choice)
        squares = np.sum((found(t) - y) ** 2)
        ends.append(f"b {found.b.value:.3f} of {top} from {start}, squares {squares:.3g}, warnings {len(seen)}")
    print(f"{name}: " + "; ".join(ends))
P
export PYTHONPATH=$root/usr/lib/python3/dist-packages HOME=$work
expect 'LevMarLSQFitter: b 1.997 of 5 from 0.5, squares 0.0544, warnings 0; b 5.000 of 5 from 5, squares 744, warnings 0; b 1.997 of 2.005 from 0.5, squares 0.0544, warnings 0
LMLSQFitter: b 1.997 of 5 from 0.5, squares 0.0544, warnings 0; b 5.000 of 5 from 5, squares 744, warnings 0; b 1.997 of 2.005 from 0.5, squares 0.0544, warnings 0
SimplexLSQFitter: b 1.997 of 5 from 0.5, squares 0.0544, warnings 0; b 5.000 of 5 from 5, squares 744, warnings 0; b 2.005 of 2.005 from 0.5, squares 0.0593, warnings 0
TRFLSQFitter: b 1.997 of 5 from 0.5, squares 0.0544, warnings 0; b 1.997 of 5 from 5, squares 0.0544, warnings 0; b 1.997 of 2.005 from 0.5, squares 0.0544, warnings 0
DogBoxLSQFitter: b 1.997 of 5 from 0.5, squares 0.0544, warnings 0; b 1.997 of 5 from 5, squares 0.0544, warnings 0; b 1.997 of 2.005 from 0.5, squares 0.0544, warnings 0
SLSQPLSQFitter: b 1.997 of 5 from 0.5, squares 0.0544, warnings 0; b 1.997 of 5 from 5, squares 0.0544, warnings 0; b 1.997 of 2.005 from 0.5, squares 0.0544, warnings 0' /usr/bin/python3 "$work/run.py"
