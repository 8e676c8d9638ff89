"""A method of scipy.optimize: python3 scipy_optimize.py lm, or trf, bfgs, l-bfgs-b …"""
import sys

from scipy.optimize import least_squares, minimize

import isoline

method = sys.argv[1]
tight = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15, "max_nfev": 10**9}
if method in ("lm", "trf", "dogbox"):
    p = isoline.optimizer(["jacobian"], f"scipy-{method}", least_squares=True)
    found = least_squares(p.residual, p.x0, p.jacobian, method=method, **tight)
else:
    p = isoline.optimizer(["pullback"], f"scipy-{method}", reports=True)
    found = minimize(p.value, p.x0, jac=p.gradient, method=method, callback=p.report)
p.finish(found.x, f"{found.message} nfev={found.nfev} njev={found.get('njev')}")
