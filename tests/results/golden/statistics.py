# What statistics.json holds: statistics by NumPy and SciPy, from their definitions, to which
# statistics_test.cpp holds ours. Made by: python3 statistics.py > statistics.json
import json
import sys

import numpy as np
import scipy
from scipy import integrate

random = np.random.default_rng(20)
INF = float("inf")


def listed(array):
    return [[("inf" if v == INF else float(v)) for v in row] for row in np.atleast_2d(array)]


# 12 problems, 5 solvers: log-uniform costs rounded to whole numbers, a sixth of them unsolved; the
# third problem by all, the fourth a tie.
costs = np.round(10 ** random.uniform(0, 3, (12, 5)))
costs[random.random((12, 5)) < 1 / 6] = INF
costs[2] = INF
costs[3, :2] = 17
least = costs.min(axis=1)
ratios = np.where(np.isfinite(costs), costs / np.where(np.isfinite(least), least, 1)[:, None], INF)
factors = [1, 1.5, 2, 4, 8, 16, 64, 1000]
shares = [[float(np.mean(ratios[:, s] <= f)) for f in factors] for s in range(5)]
fine = np.linspace(0, 6, 2**20 + 1)  # log2 of the factor up to 64


def area(s):
    finite = np.sort(ratios[:, s])
    height = np.searchsorted(finite, 2**fine, side="right") / 12
    return float(integrate.trapezoid(height, fine) / 6)


spent = np.round(random.uniform(50, 200, 9))
success = np.array([1, 0, 0, 1, 0, 1, 0, 0, 0], dtype=bool)
chance = success.mean()
ert = spent[success].mean() + (1 - chance) / chance * spent[~success].mean()

json.dump({
    "origin": f"statistics.py with NumPy {np.__version__} and SciPy {scipy.__version__}",
    "costs": listed(costs),
    "factors": factors,
    "shares": shares,
    "areas": [area(s) for s in range(5)],
    "spent": [float(s) for s in spent],
    "success": [bool(s) for s in success],
    "ert": float(ert)
}, sys.stdout, indent=1)
print()
