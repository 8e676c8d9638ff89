"""A method of lmfit's minimize: python3 lmfit_peer.py leastsq, or least_squares. It takes differences.

It needs lmfit, on Debian: apt install python3-lmfit
"""
import sys

import isoline
import lmfit

method = sys.argv[1]
p = isoline.optimizer(name=f"lmfit-{method}", least_squares=True, keeps_bounds=True, failed=1e100)
start = lmfit.Parameters()
for i in range(p.n):
    start.add(f"x{i}", p.x0[i], min=p.lower[i], max=p.upper[i])
residual = lambda given: p.residual([each.value for each in given.values()])
found = lmfit.minimize(residual, start, method=method, max_nfev=10**9)
p.finish([each.value for each in found.params.values()], f"{found.message} nfev={found.nfev}")
